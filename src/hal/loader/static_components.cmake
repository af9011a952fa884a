# kerf_add_static_components(): call it after all components are added. Makes the library kerf_static_components: the code of every
# component and the table that kerf::hal::static_components() gives.
function(kerf_add_static_components)
  if(TARGET kerf_static_components)
    return()
  endif()
  get_property(ids GLOBAL PROPERTY KERF_COMPONENTS)
  set(declarations "")
  set(rows "")
  set(objects "")
  foreach(id ${ids})
    string(APPEND declarations "extern \"C\" const kerf::hal::Module kerf_hal_module_${id};\n")
    string(APPEND rows "    {\"${id}\", &kerf_hal_module_${id}},\n")
    list(APPEND objects component_${id}_objects)
  endforeach()
  set(file ${CMAKE_BINARY_DIR}/static_components.cpp)
  file(GENERATE OUTPUT ${file} CONTENT
"// Made by CMake from the list of components.
#include \"hal/loader/module_source.hpp\"

${declarations}
namespace kerf::hal {
std::span<const StaticModule> static_components() {
  static const StaticModule table[] = {
${rows}    {nullptr, nullptr}};
  return {table, sizeof table / sizeof table[0] - 1};
}
}  // namespace kerf::hal
")
  kerf_library(kerf_static_components SOURCES ${file} LINK kerf_hal_loader ${objects})
endfunction()
