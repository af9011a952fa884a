# Python for modules and for the embedded interpreter: one search, and the one rule for a compiled module.
# Scripts say #!/usr/bin/python3, so it is the system's Python that must be able to load them.

# Sets KERF_HAS_PYTHON in the caller; `what` is left out without it, with a line that says why.
macro(kerf_find_python what)
  find_program(KERF_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
  find_program(KERF_PYTHON python3)
  set(Python_EXECUTABLE ${KERF_PYTHON})
  set(PYBIND11_FINDPYTHON ON)
  find_package(Python 3.9 COMPONENTS Interpreter Development QUIET)
  find_package(pybind11 2.9 CONFIG QUIET)
  set(KERF_HAS_PYTHON ON)
  if(NOT pybind11_FOUND OR NOT Python_FOUND)
    set(KERF_HAS_PYTHON OFF)
    message(WARNING "${what} left out: pybind11 or Python's headers are missing. "
      "`scripts/setup` installs them (Debian: pybind11-dev python3-dev)")
  elseif(CMAKE_CXX_FLAGS MATCHES "-fsanitize=")
    set(KERF_HAS_PYTHON OFF)
    message(STATUS "${what} left out: Python would have to load the sanitizer first")
  endif()
endmacro()

set(KERF_PYTHON_FOLDER ${CMAKE_BINARY_DIR}/python)

# kerf_python_module(name SOURCES ... [LINK ...])  -> build/<preset>/python/name.so
function(kerf_python_module name)
  cmake_parse_arguments(A "" "" "SOURCES;LINK" ${ARGN})
  pybind11_add_module(${name} MODULE NO_EXTRAS ${A_SOURCES})
  _kerf_common(${name})
  target_link_libraries(${name} PRIVATE ${A_LINK})
  # Its copy of our libraries is nobody else's in the interpreter.
  target_link_options(${name} PRIVATE -Wl,--exclude-libs,ALL)
  set_target_properties(${name} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${KERF_PYTHON_FOLDER})
endfunction()
