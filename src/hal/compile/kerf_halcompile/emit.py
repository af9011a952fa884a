"""A Component as C that the C API of HAL compiles.

One struct an instance; a macro an item, so that the user's code names pins as if they were variables. The user's lines keep
their place (#line), and so do conditions and sizes, so that the compiler's complaints name the .comp file."""
from . import names
from .syntax import HAL_TYPE, TYPES, c_string

MOST_NAMES = 1024
DIRECTION = {"in": "HAL_IN", "out": "HAL_OUT", "io": "HAL_IO", "r": "HAL_RO", "rw": "HAL_RW"}


class Writer:
    def __init__(self, comp, c_file, personalities):
        self.comp, self.c_file, self.personalities = comp, c_file, personalities
        self.lines = []

    def put(self, text=""):
        self.lines += text.split("\n")

    def from_source(self, offset, text):
        """A line that the compiler may complain of: of the .comp file."""
        self.put(f"#line {self.comp.with_place(offset)} {c_string(self.comp.source.name)}")
        self.put(text)
        self.back()

    def back(self):
        self.put(f"#line {len(self.lines) + 2} {c_string(self.c_file)}")

    # -- parts --

    def head(self):
        comp = self.comp
        self.put(f"/* Made by halcompile from {comp.source.name}; changes here are lost. */")
        self.put("#include <rtapi.h>")
        if comp.is_user:
            self.put("#include <stdio.h>\n#include <stdlib.h>\n#include <string.h>\n#include <errno.h>")
        else:
            self.put("#include <rtapi_app.h>\n#include <rtapi_string.h>\n#include <rtapi_errno.h>\n#include <rtapi_math64.h>")
        self.put("#include <hal.h>")
        self.put("static int comp_id;")
        for header in comp.includes:
            self.put(f"#include {header}")

    def module_info(self):
        comp = self.comp
        for kind, what in comp.order:
            if kind == "component":
                text = f"component:{comp.name}:{comp.doc or None}"
            elif kind in ("pin", "param"):
                size = "None" if not what.is_array else (f"[{what.size}]" if not what.used else f"[{what.size} : {what.used}]")
                text = ":".join([kind, what.name, what.type, size, what.dir, what.doc or "None", what.start or "None",
                                 what.condition or "None"])
            elif kind == "funct":
                text = f"funct:{what.name}:1:{what.doc or None}"
            elif kind == "option":
                text = f"option:{what[0]}:{what[1]}"
            elif kind == "variable":
                text = f"variable:{what.type}:{what.stars}{what.name}"
            elif kind == "modparam":
                text = f"modparam:{what.type}:{what.name}:{what.start}:{what.doc or None}"
            elif kind == "include":
                text = f"include:{what}"
            else:
                text = f"{'descr' if kind == 'description' else kind}:{what}"
            self.put(f"MODULE_INFO(linuxcnc, {c_string(text)});")
        self.put(f"MODULE_LICENSE({c_string(comp.texts['license'][0].splitlines()[0])});")

    def struct(self):
        comp = self.comp
        self.put("struct __comp_state {\n  struct __comp_state *_next;")
        if comp.has_personality:
            self.put("  int _personality;")
        for item in comp.items:
            ctype = TYPES[item.type][1]
            star = " *" if item.kind == "pin" and not item.is_new else " "
            size = f"[{item.size}]" if item.is_array else ""
            if comp.option("no_convenience_defines") and not item.is_new:
                # Code for 2.9 names its members as the items, the newest with _p.
                self.put(f"  union {{\n    {ctype}{star}{item.c_name}_p{size};\n    {ctype}{star}{item.c_name}{size};\n  }};")
            else:
                self.put(f"  {ctype}{star}{item.c_name}_p{size};")
        for variable in comp.variables:
            sizes = "".join(f"[{size}]" for size in variable.sizes)
            self.from_source(variable.offset, f"  {variable.type} {variable.stars}{variable.name}{sizes};")
        if comp.option("data"):
            self.put("  void *_data;")
        self.put("};")
        self.put("static struct __comp_state *__comp_first_inst, *__comp_last_inst;")
        if comp.is_user:
            self.put("static struct __comp_state *__comp_inst;")

    def declarations(self):
        comp = self.comp
        self.put("#ifndef KERF_MAYBE_UNUSED\n#define KERF_MAYBE_UNUSED __attribute__((unused))\n#endif")
        for function in comp.functions:
            self.put(f"static void {function.c_name}(struct __comp_state *__comp_inst, long period);")
            if not self.with_period:
                self.put(f"static void __no_period_{function.c_name}(struct __comp_state *__comp_inst);\n"
                         f"static void {function.c_name}(struct __comp_state *__comp_inst, long period) {{\n"
                         f"  (void)period;\n  __no_period_{function.c_name}(__comp_inst);\n}}")
        if comp.option("data"):
            self.put("static int __comp_get_data_size(void);")
        if comp.option("extra_setup"):
            self.put("static int extra_setup(struct __comp_state *__comp_inst, char *prefix, long extra_arg);")
        if comp.option("post_export"):
            self.put("static int post_export(struct __comp_state *__comp_inst, char *prefix, long extra_arg);")
        if comp.option("extra_cleanup"):
            self.put("static void extra_cleanup(void);")
        if comp.option("count_function"):
            self.put("static int get_count(void);")
        if comp.is_user:
            self.put("void user_mainloop(void);" if not comp.option("cxx") else "extern void user_mainloop(void);")
            if comp.option("userinit"):
                self.put("void userinit(int argc, char **argv);")

    @property
    def with_period(self):
        return self.comp.option("period") or self.comp.option("no_convenience_defines")

    def new_item(self, item, place, number):
        """Makes one pin or parameter at `place` of the instance."""
        family = TYPES[item.type][0]
        name = names.hal_format(item.name)
        tail = f'comp_id, "%s.{name}", prefix{number}'
        if item.is_new:
            start = item.start if item.start is not None else "0"
            self.from_source(item.offset, f'    r = hal_{item.kind}_new_{family}(comp_id, {DIRECTION[item.dir]}, &inst->{place}, {start}, '
                             f'"%s.{name}", prefix{number});')
            self.put("    if (r != 0) return r;")
            return
        self.put(f"    r = hal_{item.kind}_{family}_newf({DIRECTION[item.dir]}, &inst->{place}, {tail});")
        self.put("    if (r != 0) return r;")
        if item.start is not None:
            target = f"*inst->{place}" if item.kind == "pin" else f"inst->{place}"
            self.from_source(item.offset, f"    {target} = {item.start};")

    def export(self):
        comp = self.comp
        more = ", long personality" if comp.has_personality else ""
        self.put(f"KERF_MAYBE_UNUSED static int {self.export_name}(char *prefix, long extra_arg{more}) {{")
        self.put("  int r = 0, j = 0, n = 0;")
        self.put("  struct __comp_state *inst = (struct __comp_state *)hal_malloc((long)sizeof(struct __comp_state));")
        self.put("  (void)j, (void)n, (void)extra_arg;\n  if (inst == 0) return -ENOMEM;")
        self.put("  memset((void *)inst, 0, sizeof *inst);")
        if comp.option("data"):
            self.put("  inst->_data = hal_malloc(__comp_get_data_size());\n  if (inst->_data == 0) return -ENOMEM;")
        if comp.has_personality:
            self.put("  inst->_personality = (int)personality;")
        if comp.option("extra_setup"):
            self.put("  r = extra_setup(inst, prefix, extra_arg);\n  if (r != 0) return r;")
            if comp.has_personality:
                self.put("  personality = inst->_personality; /* EXTRA_SETUP may choose another one */")
        for item in comp.items:
            self.put("  {")
            if item.condition:
                self.from_source(item.condition_at, f"    if ({item.condition}) {{")
            else:
                self.put("    {")
            if item.is_array:
                self.from_source(item.offset, f"    n = (int)({item.used or item.size});")
                if item.used:
                    self.put(f"    if (n < 0 || n > {item.size}) {{\n"
                             f'      rtapi_print_msg(RTAPI_MSG_ERR, "{comp.name}: ERROR: %s has from 0 to {item.size} '
                             f'{names.to_hal(item.name)}, and personality %ld asks for %d\\n", prefix, (long)personality, n);\n'
                             "      return -EINVAL;\n    }")
                self.put("    for (j = 0; j < n; j++) {")
                self.new_item(item, f"{item.c_name}_p[j]", ", j")
                self.put("    }")
            else:
                self.new_item(item, f"{item.c_name}_p", "")
            self.put("    }\n  }")
        for variable in comp.variables:
            if variable.start is None:
                continue
            if variable.sizes:
                flat = " * ".join(f"({size})" for size in variable.sizes)
                first = "[0]" * len(variable.sizes)
                self.from_source(variable.offset, f"  for (j = 0; j < (int)({flat}); j++) (&inst->{variable.name}{first})[j] = {variable.start};")
            else:
                self.from_source(variable.offset, f"  inst->{variable.name} = {variable.start};")
        for function in comp.functions:
            tail = names.to_hal(function.name)
            self.put(f"  r = hal_export_functf((void (*)(void *, long)){function.c_name}, inst, 1, 0, comp_id, "
                     f'"%s{"." + tail if tail else ""}", prefix);\n  if (r != 0) return r;')
        if comp.option("post_export"):
            self.put("  r = post_export(inst, prefix, extra_arg);\n  if (r != 0) return r;")
        self.put("  if (__comp_last_inst) __comp_last_inst->_next = inst;\n  __comp_last_inst = inst;\n"
                 "  if (!__comp_first_inst) __comp_first_inst = inst;\n  return 0;\n}")

    @property
    def export_name(self):
        # `export` is a word of C++.
        return "__comp_export" if self.comp.option("cxx") else "export"

    # -- which instances --

    def parameters(self):
        comp, user = self.comp, self.comp.is_user
        if not comp.is_singleton:
            if not comp.option("count_function"):
                self.put(f"static int default_count = {comp.option('default_count', 1) if comp.option('default_count', 1) is not False else 1};\n"
                         "static int count = 0;")
                if not user:
                    self.put(f'RTAPI_MP_INT(count, "number of {comp.name}");')
            self.put(f"static char *names[{MOST_NAMES}];")
            if not user:
                self.put(f'RTAPI_MP_ARRAY_STRING(names, {MOST_NAMES}, "names of {comp.name}");')
        if comp.has_personality:
            least = comp.option("default_personality", 0) or 0
            start = ", ".join([str(least)] * self.personalities) if least else "0"
            self.put(f"static int personality[{self.personalities}] = {{{start}}};")
            if not user:
                self.put(f'RTAPI_MP_ARRAY_INT(personality, {self.personalities}, "personality of each {comp.name}");')

    def modparams(self):
        for parameter in self.comp.modparams:
            if parameter.type == "dummy":
                continue
            self.from_source(parameter.offset, f"static int {parameter.name} = {parameter.start};")
            if not self.comp.is_user:
                self.put(f"RTAPI_MP_INT({parameter.name}, {c_string(parameter.doc)});")

    def export_all(self):
        """All instances, as count=, names= and personality= say."""
        comp = self.comp
        personality = ""
        if comp.has_personality and not comp.is_singleton:
            self.put_personality()
        self.put("static int __comp_export_all(void) {")
        if comp.is_singleton:
            if comp.has_personality:
                personality = ", personality[0]"
            self.put(f"  char prefix[HAL_NAME_LEN + 1];\n  rtapi_snprintf(prefix, sizeof prefix, \"{comp.hal_name}\");\n"
                     f"  return {self.export_name}(prefix, 0{personality});\n}}")
            return
        if comp.has_personality:
            personality = ", __comp_personality(i)"
        self.put("  char prefix[HAL_NAME_LEN + 1];\n  int i, r = 0, named = 0, wanted;")
        self.put(f"  while (named < {MOST_NAMES} && names[named] && names[named][0]) named++;")
        self.put(f"  if (named < {MOST_NAMES} && names[named]) {{\n"
                 f'    rtapi_print_msg(RTAPI_MSG_ERR, "{comp.name}: ERROR: a name in names= is empty\\n");\n    return -EINVAL;\n  }}')
        if comp.option("count_function"):
            self.put("  wanted = get_count();\n  if (wanted < 0) return wanted;")
            self.put("  if (named && named != wanted) {\n"
                     f'    rtapi_print_msg(RTAPI_MSG_ERR, "{comp.name}: ERROR: names= has %d names, and there are %d\\n", named, wanted);\n'
                     "    return -EINVAL;\n  }")
        else:
            self.put("  if (count && named) {\n"
                     f'    rtapi_print_msg(RTAPI_MSG_ERR, "{comp.name}: ERROR: count= and names= are mutually exclusive\\n");\n'
                     "    return -EINVAL;\n  }")
            self.put("  wanted = named ? named : count ? count : default_count;\n"
                     "  if (wanted < 0) {\n"
                     f'    rtapi_print_msg(RTAPI_MSG_ERR, "{comp.name}: ERROR: count=%d: it must be 0 or more\\n", wanted);\n'
                     "    return -EINVAL;\n  }")
        self.put("  for (i = 0; i < wanted && r == 0; i++) {\n"
                 '    if (named) rtapi_snprintf(prefix, sizeof prefix, "%s", names[i]);\n'
                 f'    else rtapi_snprintf(prefix, sizeof prefix, "{comp.hal_name}.%d", i);\n'
                 f"    r = {self.export_name}(prefix, i{personality});\n  }}\n  return r;\n}}")

    def put_personality(self):
        self.put("static long __comp_personality(int i) {\n"
                 f"  const int known = {self.personalities};\n"
                 "  if (i >= known) rtapi_print_msg(RTAPI_MSG_ERR, \"%s: instance %d takes personality %d of the %d there may be\\n\", "
                 f"\"{self.comp.name}\", i, i % known, known);\n"
                 "  return personality[i % known];\n}")

    def realtime_main(self):
        comp = self.comp
        if not comp.option("rtapi_app"):
            if comp.option("cxx"):
                self.put("#define export __comp_export")
            return
        self.export_all()
        cleanup = "    extra_cleanup();\n" if comp.option("extra_cleanup") else ""
        if comp.option("constructable") and not comp.is_singleton:
            self.put("static int __comp_make(const char *prefix, const char *arg) {\n"
                     "  char own[HAL_NAME_LEN + 1];\n  const long n = arg && *arg ? simple_strtol(arg, 0, 0) : 0;\n"
                     '  rtapi_snprintf(own, sizeof own, "%s", prefix);\n'
                     f"  return {self.export_name}(own, n{', n' if comp.has_personality else ''});\n}}")
        self.put(f'int rtapi_app_main(void) {{\n  int r;\n  comp_id = hal_init("{comp.name}");\n  if (comp_id < 0) return comp_id;\n'
                 "  r = __comp_export_all();")
        self.put(f"  if (r != 0) {{\n{cleanup}    hal_exit(comp_id);\n    return r < 0 ? r : -EINVAL;\n  }}")
        if comp.option("constructable") and not comp.is_singleton:
            self.put("  hal_set_constructor(comp_id, __comp_make);")
        self.put("  hal_ready(comp_id);\n  return 0;\n}")
        self.put(f"void rtapi_app_exit(void) {{\n{cleanup}  hal_exit(comp_id);\n}}")

    def user_main(self):
        comp = self.comp
        self.export_all()
        self.put("KERF_MAYBE_UNUSED static int __comp_number(const char *word, const char *text, int *value) {\n"
                 "  char *end;\n  errno = 0;\n  *value = (int)strtol(text, &end, 0);\n"
                 "  if (*text && *end == 0 && errno == 0) return 0;\n"
                 f'  fprintf(stderr, "{comp.name}: %s: a whole number must follow the \'=\'\\n", word);\n  return -1;\n}}')
        # Words that are not ours are userinit's.
        self.put("static int __comp_argument(char *word) {\n  (void)word;")
        if not comp.is_singleton:
            if not comp.option("count_function"):
                self.put('  if (strncmp(word, "count=", 6) == 0) return __comp_number(word, word + 6, &count);')
            self.put('  if (strncmp(word, "names=", 6) == 0) {\n    int n = 0;\n    char *at = word + 6;\n'
                     f"    while (at && n < {MOST_NAMES}) {{\n      names[n++] = at;\n      at = strchr(at, ',');\n"
                     "      if (at) *at++ = 0;\n    }\n    return 0;\n  }")
        if comp.has_personality:
            self.put('  if (strncmp(word, "personality=", 12) == 0) {\n    int n = 0;\n    char *at = word + 12;\n'
                     f"    while (at && n < {self.personalities}) {{\n      char *next = strchr(at, ',');\n      if (next) *next++ = 0;\n"
                     "      if (__comp_number(\"personality=\", at, &personality[n++]) != 0) return -1;\n      at = next;\n    }\n    return 0;\n  }")
        for parameter in comp.modparams:
            if parameter.type == "int":
                length = len(parameter.name) + 1
                self.put(f'  if (strncmp(word, "{parameter.name}=", {length}) == 0) return __comp_number(word, word + {length}, &{parameter.name});')
        if not comp.option("userinit"):
            words = [] if comp.is_singleton else ["count=N", "names=NAME,..."][bool(comp.option("count_function")):]
            words += ["personality=N,..."] * comp.has_personality + [f"{p.name}=N" for p in comp.modparams if p.type == "int"]
            usage = f"Usage: {comp.name} " + " ".join(f"[{w}]" for w in words)
            self.put(f'  if (strcmp(word, "--help") == 0) {{\n    puts({c_string(usage)});\n    exit(0);\n  }}')
            self.put(f'  fprintf(stderr, "{comp.name}: warning: \'%s\' has no meaning here; see --help\\n", word);')
        self.put("  return 0;\n}")
        cleanup = "    extra_cleanup();\n" if comp.option("extra_cleanup") else ""
        self.put("int main(int argc, char **argv) {\n  int i, r;")
        if comp.option("userinit"):
            self.put("  userinit(argc, argv);")
        self.put("  for (i = 1; i < argc; i++)\n    if (__comp_argument(argv[i]) != 0) return 1;")
        self.put(f'  comp_id = hal_init("{comp.name}");\n  if (comp_id < 0) return 1;\n  r = __comp_export_all();\n'
                 f"  if (r != 0) {{\n{cleanup}    hal_exit(comp_id);\n    return 1;\n  }}\n"
                 f"  hal_ready(comp_id);\n  user_mainloop();\n{cleanup}  hal_exit(comp_id);\n  return 0;\n}}")

    # -- what the user's code says --

    def define(self, name, text):
        bare = name.split("(")[0]
        self.put(f"#undef {bare}\n#define {name} {text}")

    def macros(self):
        comp = self.comp
        if comp.option("no_convenience_defines"):
            return
        if comp.is_user:
            self.define("FOR_ALL_INSTS()", "for (__comp_inst = __comp_first_inst; __comp_inst; __comp_inst = __comp_inst->_next)")
        else:
            head = "static void __no_period_##name(struct __comp_state *__comp_inst)" if not self.with_period else \
                   "static void name(struct __comp_state *__comp_inst KERF_MAYBE_UNUSED, long period KERF_MAYBE_UNUSED)"
            self.define("FUNCTION(name)", head)
            if self.with_period:
                self.define("fperiod", "(period * 1e-9)")
            self.define("FOR_ALL_INSTS()", "for (struct __comp_state *__comp_inst = __comp_first_inst; __comp_inst; __comp_inst = __comp_inst->_next)")
        arguments = "struct __comp_state *__comp_inst KERF_MAYBE_UNUSED, char *prefix KERF_MAYBE_UNUSED, long extra_arg KERF_MAYBE_UNUSED"
        self.define("EXTRA_SETUP()", f"static int extra_setup({arguments})")
        self.define("POST_EXPORT()", f"static int post_export({arguments})")
        self.define("EXTRA_CLEANUP()", "static void extra_cleanup(void)")
        self.put("#ifndef TRUE\n#define TRUE (1)\n#endif\n#ifndef FALSE\n#define FALSE (0)\n#endif")
        if comp.has_personality:
            self.define("personality", "(__comp_inst->_personality)")
        if comp.option("data"):
            self.define("data", f"(*({comp.option('data')} *)__comp_inst->_data)")
        taken = {item.c_name for item in comp.items} | {v.name for v in comp.variables} | {f.c_name for f in comp.functions}
        for item in comp.items:
            self.item_macros(item, taken)
        for variable in comp.variables:
            self.define(variable.name, f"(__comp_inst->{variable.name})")

    def item_macros(self, item, taken):
        name = item.c_name
        place, arguments, first = (f"__comp_inst->{name}_p[i]", "(i)", "i, ") if item.is_array else (f"__comp_inst->{name}_p", "", "")
        if item.is_new:
            family = TYPES[item.type][0]
            self.define(f"{name}{arguments}", f"(hal_get_{family}({place}))")
            if not (item.kind == "pin" and item.dir == "in") and f"{name}_set" not in taken:
                self.define(f"{name}_set({first}v)", f"(hal_set_{family}({place}, (v)))")
        elif item.kind == "param":
            self.define(f"{name}{arguments}", f"({place})")
        elif item.dir == "in":
            self.define(f"{name}{arguments}", f"(0 + *{place})")
        else:
            self.define(f"{name}{arguments}", f"(*{place})")
        if item.kind == "pin" and f"{name}_ptr" not in taken:
            self.define(f"{name}_ptr{arguments}", f"({place})")

    def body(self):
        comp = self.comp
        wrapped = len(comp.functions) == 1 and "FUNCTION" not in comp.body and not comp.option("no_convenience_defines")
        if wrapped:
            self.put(f"FUNCTION({comp.functions[0].c_name}) {{")
        self.put(f"#line {comp.body_line} {c_string(comp.source.name)}")
        self.put(comp.body.rstrip("\n"))
        self.back()
        if wrapped:
            self.put("}")
        if comp.option("data"):
            self.put(f"static int __comp_get_data_size(void) {{ return (int)sizeof({comp.option('data')}); }}")

    def text(self):
        self.head()
        if not self.comp.is_user:
            self.module_info()
        self.modparams()
        self.struct()
        self.declarations()
        self.export_parts()
        self.macros()
        self.body()
        return "\n".join(self.lines) + "\n"

    def export_parts(self):
        comp = self.comp
        self.export()
        if comp.is_user or comp.option("rtapi_app"):
            self.parameters()
        if comp.is_user:
            self.user_main()
        else:
            self.realtime_main()


def to_c(comp, c_file, personalities=64):
    return Writer(comp, c_file, personalities).text()


def hal_type(item):
    return HAL_TYPE.get(item.type, item.type)
