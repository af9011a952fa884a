"""Which constructs of the .comp language, and which options of halcompile, the cases use: `missing` must find none, so that a
word added to the language is not forgotten here."""
import pathlib
import re
import sys

TOP = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(TOP / "src/hal/compile"))
sys.dont_write_bytecode = True
from kerf_halcompile import lexer, syntax  # noqa: E402  pylint: disable=wrong-import-position

# In the C code behind ;;
MACROS = {
    "FUNCTION(name)": r"\bFUNCTION\s*\(", "EXTRA_SETUP": r"\bEXTRA_SETUP\s*\(", "EXTRA_CLEANUP": r"\bEXTRA_CLEANUP\s*\(",
    "POST_EXPORT": r"\bPOST_EXPORT\s*\(", "FOR_ALL_INSTS": r"\bFOR_ALL_INSTS\s*\(\)", "fperiod": r"\bfperiod\b",
    "period": r"\bperiod\b", "data": r"\bdata\b", "personality": r"\bpersonality\b", "extra_arg": r"\bextra_arg\b",
    "prefix": r"\bprefix\b", "comp_id": r"\bcomp_id\b", "get_count": r"\bget_count\s*\(", "userinit": r"\buserinit\s*\(",
    "user_mainloop": r"\buser_mainloop\s*\(", "rtapi_app_main": r"\brtapi_app_main\s*\(", "rtapi_app_exit": r"\brtapi_app_exit\s*\(",
    "export(prefix, extra_arg)": r"\bexport\s*\(", "NAME_set(value)": r"\w_set\s*\([^,()]*\)", "NAME_set(index, value)": r"\w_set\s*\([^,()]+,",
    "NAME_ptr": r"\w_ptr\b(?!\s*\()", "NAME_ptr(index)": r"\w_ptr\s*\(", "RTAPI_MP_INT": r"\bRTAPI_MP_INT\s*\(",
    "RTAPI_MP_ARRAY_INT": r"\bRTAPI_MP_ARRAY_INT\s*\(", "RTAPI_MP_STRING": r"\bRTAPI_MP_STRING\s*\(",
    "#include in the code": r"^\s*#\s*include\b", "a function called with __comp_state": r"\bstruct __comp_state\b",
}
# How things are spelt in the declarations.
SPELLINGS = {
    "// comment": r"//", "/* comment */": r"/\*", 'text "..."': r'[^"]"[^"\n]+"', 'text """..."""': r'[^r]"""', 'text r"..."': r'\br"[^"]',
    'text r"""..."""': r'\br"""', "escape in a text": r'"[^"\n]*\\\\[^"\n]*"', "lines of DOS": r"\r\n", "fp": r"\bfunction\s+\S+\s+fp\b",
    "nofp": r"\bfunction\s+\S+\s+nofp\b", "number 0x": r"=\s*[-+]?0x", "number 0b": r"=\s*[-+]?0b", "number 0o": r"=\s*[-+]?0o",
    "number with exponent": r"=\s*[-+]?[\d.]+e[-+]?\d", "number with sign": r"=\s*[-+]\d", "start value TRUE": r"=\s*TRUE",
    "start value true": r"=\s*true", "start value yes": r"=\s*yes",
}
OPTION_VALUES = ("yes", "no", "true", "false", "TRUE", "FALSE", "0", "1", "nothing")


def wanted():
    """Every construct, from the tables of the compiler."""
    out = set(MACROS) | set(SPELLINGS)
    for type_ in syntax.TYPES:
        out |= {f"pin {dir_} {type_}" for dir_ in ("in", "out")}
        if type_ != "port":
            out |= {f"pin io {type_}"} | {f"param {dir_} {type_}" for dir_ in ("r", "rw")} | {f"start value of {type_}"}
    for kind in ("pin", "param"):
        out |= {f"{kind} array", f"{kind} array of as many as personality says", f"{kind} if", f"{kind} array if",
                f"{kind} array with start value", f"{kind} with a text"}
    out |= {f"option {name}" for name in syntax.OPTIONS} | {f"option value {value}" for value in OPTION_VALUES}
    out |= {f"declaration {name}" for name in syntax.DECLARATIONS}
    out |= {"several authors", "modparam int without value", "modparam dummy", "include <>", 'include ""', "function _", "two functions",
            "component with a text", "function with a text", "code without FUNCTION", "hal_ in front of the name", "name with _ at its end",
            "name with .", "name with -", "name with ##", "variable that is a pointer", "variable of several sizes", "variable array",
            "variable with value", "variable array with value", "variable of a type of several words", "condition with ()",
            "userspace with personality", "userspace with modparam", "userspace with arrays"}
    return out


def used_by(path):
    """The constructs in one .comp file."""
    data = path.read_bytes()
    raw = data.decode()
    comp = syntax.Parser(lexer.Source(path.name, raw.replace("\r\n", "\n"))).parse()
    head = raw[:len(raw) - len(comp.body)] if "\r\n" not in raw else raw.split("\r\n;;")[0] + "\r\n"
    out = {name for name, pattern in MACROS.items() if re.search(pattern, comp.body, re.M)}
    out |= {name for name, pattern in SPELLINGS.items() if re.search(pattern, head, re.I if "exponent" in name else 0)}
    for item in comp.items:
        out.add(f"{item.kind} {item.dir} {item.type}")
        for fact, name in ((item.is_array, "array"), (item.used, "array of as many as personality says"), (item.condition, "if"),
                           (item.is_array and item.condition, "array if"), (item.is_array and item.start is not None, "array with start value"),
                           (item.doc, "with a text")):
            if fact:
                out.add(f"{item.kind} {name}")
        if item.start is not None:
            out.add(f"start value of {item.type}")
        if item.condition and "(" in item.condition:
            out.add("condition with ()")
    for name, _, offset in (what for kind, what in comp.order if kind == "option"):
        out.add(f"option {name}")
        spelt = re.match(rf"{name}\s*([^;\s]*)", comp.source.text[offset:] if comp.source.text.startswith(name, offset) else "")
        out.add(f"option value {(spelt[1] if spelt else '') or 'nothing'}")
    out |= {f"declaration {'function' if kind == 'funct' else kind}" for kind, _ in comp.order}
    for variable in comp.variables:
        for fact, name in ((variable.stars, "that is a pointer"), (len(variable.sizes) > 1, "of several sizes"), (variable.sizes, "array"),
                           (variable.start is not None, "with value"), (variable.sizes and variable.start is not None, "array with value"),
                           (" " in variable.type, "of a type of several words")):
            if fact:
                out.add(f"variable {name}")
    names = [entry.name for entry in [*comp.items, *comp.functions]]
    facts = {
        "a program": comp.is_user, "several authors": len(comp.texts["author"]) > 1,
        "modparam int without value": any(re.search(rf"modparam\s+int\s+{p.name}\s*[\";]", head) for p in comp.modparams if p.type == "int"),
        "modparam dummy": any(p.type == "dummy" for p in comp.modparams),
        "include <>": any(i.startswith("<") for i in comp.includes), 'include ""': any(i.startswith('"') for i in comp.includes),
        "function _": any(f.name == "_" for f in comp.functions), "two functions": len(comp.functions) > 1,
        "component with a text": comp.doc, "function with a text": any(f.doc for f in comp.functions),
        "code without FUNCTION": comp.functions and "FUNCTION" not in comp.body, "hal_ in front of the name": comp.name.startswith("hal_"),
        "name with _ at its end": any(len(n) > 1 and n.endswith("_") for n in names), "name with .": any("." in n for n in names),
        "name with -": any(re.search(r"\w-\w", n) for n in names), "name with ##": any("##" in n for n in names),
        "userspace with personality": comp.is_user and comp.has_personality, "userspace with modparam": comp.is_user and comp.modparams,
        "userspace with arrays": comp.is_user and any(i.is_array for i in comp.items),
    }
    return out | {name for name, fact in facts.items() if fact}


def options_wanted(help_text):
    return set(re.findall(r"--[a-z][a-z-]+", help_text.split("\n\n", 2)[2].split("CC and CXX")[0]))


def missing(cases, help_text):
    """(constructs there are, those that no case uses, counts for the last line)."""
    comps = [p for case in cases if case.name != "wrong" for p in sorted(case.glob("*.comp"))]
    used, users, arrays, modules = set(), 0, 0, 0
    for path in comps:
        found = used_by(path)
        used |= found
        users += "a program" in found
        arrays += bool({f"{kind} array of as many as personality says" for kind in ("pin", "param")} & found)
        modules += bool({"option homemod", "option tpmod"} & found) or "kinematicsForward" in path.read_text()
    said = " ".join(p.read_text() for case in cases for p in [*case.glob("test.sh"), *case.glob("options")])
    all_of_them = wanted() | options_wanted(help_text)
    used |= {option for option in options_wanted(help_text) if re.search(rf"(?<![\w-]){option}(?![\w-])", said)} | {"--compile"}
    sources = sum(len(list(case.glob("*.c"))) for case in cases)
    wrong = sum(len(list(case.glob("*.comp"))) for case in cases if case.name == "wrong")
    counts = (f"{len(comps)} .comp files compile and run, of these {users} programs, {arrays} with arrays by personality, {modules} modules of "
              f"kinematics, homing or planning; {wrong} wrong ones give FILE:LINE; {sources} C sources")
    return all_of_them, all_of_them - used, counts
