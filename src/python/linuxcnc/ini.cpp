// linuxcnc.ini: values of an INI file, read by the same reader as all of Kerf.
#include <cstdio>

#include "ini/convert.hpp"
#include "ini/ini_file.hpp"
#include "python/linuxcnc/module.hpp"

namespace kerf::python {
namespace {

class IniObject {
 public:
  explicit IniObject(const std::string& file) {
    auto loaded = ini::IniFile::load(file);
    for (const auto& d : loaded.diagnostics) std::fprintf(stderr, "%s\n", d.message().c_str());
    if (!loaded.ok) throw_error("inifile.open(" + file + ") failed");
    file_ = std::move(loaded.file);
  }
  [[nodiscard]] const ini::IniFile& file() const { return file_; }
  [[nodiscard]] const ini::Entry* find(const std::string& section, const std::string& variable,
                                       int num) const {
    if (num < 1) throw_error("Argument 'num' must be >= 1.");
    return file_.find(section, variable, static_cast<std::size_t>(num));
  }

 private:
  ini::IniFile file_;
};

/// To stderr: a script that gets None wants to know why.
void complain(const ini::Entry& entry, const char* expected) {
  std::fprintf(stderr, "%s: error: [%s]%s = '%s': expected %s\n", entry.at.text().c_str(),
               entry.section.c_str(), entry.key.c_str(), entry.value.c_str(), expected);
}
void warn_rest(const ini::Entry& entry) {
  std::fprintf(stderr, "%s: warning: [%s]%s = '%s': what follows the number is not read\n",
               entry.at.text().c_str(), entry.section.c_str(), entry.key.c_str(),
               entry.value.c_str());
}

/// Python's value of an entry; none: not convertible.
using Convert = py::object (*)(const ini::Entry&);

py::object to_string(const ini::Entry& e) { return py::str(e.value); }

template <class N>
py::object number(const ini::Entry& e, const N& n, const char* expected) {
  if (!n.valid) {
    complain(e, expected);
    return py::none();
  }
  if (n.has_trailing()) warn_rest(e);
  return py::cast(n.value);
}
py::object to_int(const ini::Entry& e) { return number(e, ini::to_int(e.value), "a whole number"); }
py::object to_uint(const ini::Entry& e) {
  const auto n = ini::to_uint(e.value);
  if (n.valid && !n.negated) return number(e, n, "");
  complain(e, "a whole number, 0 or more");
  return py::none();
}
py::object to_real(const ini::Entry& e) { return number(e, ini::to_real(e.value), "a number"); }
py::object to_bool(const ini::Entry& e) {
  if (const auto b = ini::to_bool(e.value)) return py::bool_(*b);
  complain(e, "TRUE, YES, ON, 1, FALSE, NO, OFF or 0");
  return py::none();
}

/// Units in 1 mm, as LinuxCNC counts them.
py::object linear_units(const std::string& text) {
  if (const auto mm = ini::mm_per_unit(text)) return py::float_(1 / *mm);
  if (const auto n = ini::to_real(text); n.valid && n.rest.empty() && n.value > 0)
    return py::float_(n.value);
  return py::none();
}
py::object angular_units(const std::string& text) {
  if (const auto deg = ini::deg_per_unit(text)) return py::float_(1 / *deg);
  if (const auto n = ini::to_real(text); n.valid && n.rest.empty() && n.value > 0)
    return py::float_(n.value);
  return py::none();
}
py::object joint_type(const std::string& text) {
  if (ini::equal_ignoring_case(text, "LINEAR")) return py::int_(1);
  if (ini::equal_ignoring_case(text, "ANGULAR")) return py::int_(2);
  return py::none();
}

template <py::object (*map)(const std::string&)>
py::object mapped(const ini::Entry& e) {
  py::object value = map(e.value);
  if (value.is_none()) complain(e, "a unit or type that the manual names");
  return value;
}

using Class = py::class_<IniObject>;

void add_getter(Class& c, const char* name, Convert convert) {
  c.def(
      name,
      [convert](const IniObject& o, const std::string& section, const std::string& variable,
                int num, const py::object& fallback) {
        const ini::Entry* entry = o.find(section, variable, num);
        py::object value = entry == nullptr ? py::object(py::none()) : convert(*entry);
        return value.is_none() ? fallback : value;
      },
      py::arg("section"), py::arg("variable"), py::arg("num") = 1,
      py::arg("fallback") = py::none());
}

void add_map(Class& c, const char* name, py::object (*map)(const std::string&)) {
  c.def(
      name,
      [map](const IniObject&, const std::string& text, const py::object& fallback) {
        py::object value = map(text);
        return value.is_none() ? fallback : value;
      },
      py::arg("text"), py::arg("fallback") = py::none());
}

py::list find_all(const IniObject& o, const std::string& section, const std::string& variable) {
  py::list out;
  for (const ini::Entry* entry : o.file().find_all(section, variable)) out.append(entry->value);
  return out;
}

py::list variables(const IniObject& o, const std::string& section) {
  py::list out;
  for (const ini::Entry* entry : o.file().variables(section))
    out.append(py::make_tuple(entry->key, entry->value));
  return out;
}

py::tuple line_of(const IniObject& o, const std::string& section, const std::string& variable,
                  int num) {
  const ini::Entry* entry = o.find(section, variable, num);
  if (entry == nullptr) return py::make_tuple(py::none(), py::none());
  return py::make_tuple(entry->at.file, entry->at.line);
}

}  // namespace

void add_ini(py::module_& m) {
  Class c(m, "ini", "ini(FILE): values of an INI file. An empty section means any.");
  c.attr("__module__") = "linuxcnc";
  c.def(py::init<const std::string&>(), py::arg("file"));
  for (const char* name : {"find", "getstring"}) add_getter(c, name, to_string);
  for (const char* name : {"getint", "getsint"}) add_getter(c, name, to_int);
  add_getter(c, "getuint", to_uint);
  for (const char* name : {"getfloat", "getreal"}) add_getter(c, name, to_real);
  add_getter(c, "getbool", to_bool);
  add_getter(c, "getlinearunits", mapped<linear_units>);
  add_getter(c, "getangularunits", mapped<angular_units>);
  add_getter(c, "getjointtype", mapped<joint_type>);
  add_map(c, "maplinearunits", linear_units);
  add_map(c, "mapangularunits", angular_units);
  add_map(c, "mapjointtype", joint_type);
  c.def("findall", find_all, py::arg("section"), py::arg("variable") = "")
      .def("getsections",
           [](const IniObject& o) {
             py::list out;
             for (const auto& section : o.file().sections()) out.append(section);
             return out;
           })
      .def("getvariables", variables, py::arg("section") = "")
      .def(
          "hassection",
          [](const IniObject& o, const std::string& s) { return o.file().has_section(s); },
          py::arg("section"))
      .def(
          "hasvariable",
          [](const IniObject& o, const std::string& section, const std::string& variable, int num) {
            return o.find(section, variable, num) != nullptr;
          },
          py::arg("section"), py::arg("variable"), py::arg("num") = 1)
      .def("lineof", line_of, py::arg("section"), py::arg("variable"), py::arg("num") = 1);
}

}  // namespace kerf::python
