"""The declarations of a .comp file as one Component, checked."""
import dataclasses
import difflib
import os
import re
from typing import List, Optional

from . import lexer, names

# .comp type -> (name in the functions of hal.h, type of C, of the newest kind)
TYPES = {
    "bit": ("bit", "hal_bit_t", False), "float": ("float", "hal_float_t", False), "s32": ("s32", "hal_s32_t", False),
    "u32": ("u32", "hal_u32_t", False), "s64": ("s64", "hal_s64_t", False), "u64": ("u64", "hal_u64_t", False),
    "port": ("port", "hal_port_t", False), "signed": ("s32", "hal_s32_t", False), "unsigned": ("u32", "hal_u32_t", False),
    "bool": ("bool", "hal_bool_t", True), "real": ("real", "hal_real_t", True), "sint": ("sint", "hal_sint_t", True),
    "uint": ("uint", "hal_uint_t", True), "si32": ("si32", "hal_sint_t", True), "ui32": ("ui32", "hal_uint_t", True),
}
# HAL's name of the type, for documentation.
HAL_TYPE = {"signed": "s32", "unsigned": "u32", "bool": "bit", "real": "float", "sint": "s64", "uint": "u64", "si32": "s32", "ui32": "u32"}
YES, NUMBER, NAME, TEXT = "yes or no", "a number", "a type", "a text"
OPTIONS = {
    "singleton": YES, "default_count": NUMBER, "count_function": YES, "rtapi_app": YES, "data": NAME, "extra_setup": YES,
    "extra_cleanup": YES, "post_export": YES, "constructable": YES, "default_personality": NUMBER, "userspace": YES, "userinit": YES,
    "extra_compile_args": TEXT, "extra_link_args": TEXT, "no_convenience_defines": YES, "homemod": YES, "tpmod": YES, "period": YES,
    "cxx": YES,
}
DEFAULTS = {"rtapi_app": True, "constructable": True, "period": True}
YES_OR_NO = {"yes": True, "true": True, "TRUE": True, "1": True, "no": False, "false": False, "FALSE": False, "0": False}
TEXTS = ("description", "examples", "notes", "see_also", "license", "author")
DECLARATIONS = ("component", "pin", "param", "function", "option", "variable", "modparam", "include") + TEXTS


@dataclasses.dataclass
class Item:
    """A pin or a parameter."""
    kind: str  # pin, param
    name: str
    type: str
    dir: str
    offset: int
    size: Optional[int] = None  # of an array: the most
    used: Optional[str] = None  # of an array: how many, an expression
    condition: Optional[str] = None
    condition_at: int = 0
    start: Optional[str] = None
    doc: str = ""

    @property
    def c_name(self):
        return names.to_c(self.name)

    @property
    def is_new(self):
        return TYPES[self.type][2]

    @property
    def is_array(self):
        return self.size is not None


@dataclasses.dataclass
class Function:
    name: str
    doc: str
    offset: int

    @property
    def c_name(self):
        return names.to_c(self.name)


@dataclasses.dataclass
class Variable:
    type: str
    stars: str
    name: str
    sizes: List[int]
    start: Optional[str]
    offset: int


@dataclasses.dataclass
class ModuleParameter:
    type: str  # int, dummy
    name: str
    start: str
    doc: str
    offset: int


class Component:
    def __init__(self, source):
        self.source = source
        self.name, self.doc, self.name_at = "", "", 0
        self.items, self.functions, self.variables, self.modparams, self.includes = [], [], [], [], []
        self.texts = {kind: [] for kind in TEXTS}
        self.options = dict(DEFAULTS)
        self.order = []  # all declarations as they stand: (kind, object)
        self.warnings = []
        self.body, self.body_line = "", 0

    def option(self, name, otherwise=False):
        return self.options.get(name, otherwise)

    @property
    def is_user(self):
        return bool(self.option("userspace"))

    @property
    def is_singleton(self):
        return bool(self.option("singleton") or self.option("homemod") or self.option("tpmod"))

    @property
    def has_personality(self):
        return any(item.condition or item.used for item in self.items)

    @property
    def pins(self):
        return [item for item in self.items if item.kind == "pin"]

    @property
    def params(self):
        return [item for item in self.items if item.kind == "param"]

    @property
    def hal_name(self):
        return names.component_to_hal(self.name)

    def with_place(self, offset):
        line, _ = self.source.place(offset)
        return line


class Parser:
    def __init__(self, source):
        self.lex = lexer.Lexer(source)
        self.source = source
        self.component = Component(source)
        self.taken = {}

    # -- pieces --

    def need(self, token, what, hint=""):
        if token is None:
            self.lex.fail(f"Expected {what}, found {self.lex.shown()}", hint)
        return token

    def sign(self, text, hint=""):
        if not self.lex.accept(text):
            self.lex.fail(f"Expected '{text}', found {self.lex.shown()}", hint)

    def one_of(self, words, what):
        at = self.lex.at
        token = self.need(self.lex.match("word", lexer.IDENTIFIER), what + ": " + ", ".join(words))
        if token.text not in words:
            near = difflib.get_close_matches(token.text, words, 1)
            self.lex.at = at
            self.lex.fail(f"'{token.text}' is no {what}", (f"Did you mean '{near[0]}'? " if near else "") + "Known: " + ", ".join(words),
                          token.offset)
        return token

    def number(self, what, least=0):
        token = self.need(self.lex.match("number", lexer.NUMBER), what)
        value = self.whole(token.text, token.offset)
        if value < least:
            self.lex.fail(f"{what} {value}: at least {least}", offset=token.offset)
        return value

    def whole(self, text, offset):
        try:
            return int(text, 0 if re.match(r"[-+]?0[xXbBoO]", text) else 10)
        except ValueError:
            self.lex.fail(f"'{text}' is no whole number", offset=offset)

    def value(self):
        """A start value, spelt for C."""
        number = self.lex.match("number", lexer.NUMBER)
        if number:
            return re.sub(r"0[oO]", "0", number.text)
        string = self.lex.string()
        if string:
            return c_string(string.text)
        word = self.need(self.lex.match("name", lexer.IDENTIFIER), "a value: a number, TRUE, FALSE or a name")
        return {"yes": "1", "no": "0", "true": "1", "false": "0", "TRUE": "1", "FALSE": "0"}.get(word.text, word.text)

    def doc(self):
        """An optional text."""
        string = self.lex.string()
        return string.text if string else ""

    def hal_name(self, what):
        return self.need(self.lex.match("hal name", lexer.HAL_NAME), what,
                         "A name begins with a letter or '_'; letters, digits, '_', '-', '.' and '#' may follow.")

    def take(self, c_name, token_offset):
        """Each name once."""
        if c_name in names.RESERVED or c_name.startswith("__comp"):
            self.lex.fail(f"Variable name {c_name} is reserved", "Take another one, or put a '_' at its end.", token_offset)
        if c_name in names.C_WORDS:
            self.lex.fail(f"Name {c_name} is a word of the language C",
                          f"Write {c_name}_ : in HAL its name is {c_name} all the same.", token_offset)
        if c_name in self.taken:
            line, _ = self.source.place(self.taken[c_name])
            self.lex.fail(f"Duplicate item name {c_name}", f"It is taken in line {line}; pins, parameters, functions and variables "
                          "need names that differ.", token_offset)
        self.taken[c_name] = token_offset

    # -- declarations --

    def parse(self):
        lex = self.lex
        while True:
            lex.skip()
            if lex.text.startswith(";;", lex.at):
                return self.finish()
            if lex.at >= len(lex.text):
                lex.fail("Expected ';;' on a line of its own between declarations and C code, found the end of the file",
                         "Without code of its own, a component still needs the line.")
            begin = lex.at
            word = self.one_of(DECLARATIONS, "declaration")
            if word.text != "component" and not self.component.name:
                lex.fail("The first declaration must be 'component NAME;'", offset=begin)
            getattr(self, "on_" + word.text if word.text not in TEXTS else "on_text")(word)
            self.sign(";", "Each declaration ends with one ';'.")

    def on_component(self, word):
        comp = self.component
        if comp.name:
            self.lex.fail("More than one 'component' declaration", "One file describes one component.", word.offset)
        token = self.hal_name("the component's name")
        comp.name, comp.name_at, comp.doc = token.text, token.offset, self.doc()
        stem = os.path.splitext(os.path.basename(self.source.name))[0]
        if comp.name != stem:
            self.lex.fail(f"Component name ({comp.name}) does not match filename ({stem})",
                          "loadrt finds it by the file's name: rename one of them.", token.offset)
        comp.order.append(("component", comp))

    def item(self, kind, directions):
        direction = self.one_of(directions, f"{kind} direction").text
        type_ = self.one_of(tuple(TYPES), "type").text
        name = self.hal_name(f"the {kind}'s name")
        item = Item(kind, name.text, type_, direction, name.offset)
        lex = self.lex
        if type_ == "port" and kind == "param":
            lex.fail("A parameter cannot be a port", "Ports are pins.", name.offset)
        if type_ == "port" and direction == "io":
            lex.fail("A port cannot be io", "One end writes, the other reads: out or in.", name.offset)
        if lex.accept("["):
            item.size = self.number("The size of an array", 1)
            if lex.accept(":"):
                item.used = lex.expression("]").text
            self.sign("]")
        # The manual has the condition first; LinuxCNC's files have either order.
        while True:
            if item.condition is None and lex.accept("if"):
                condition = lex.expression(";=")
                item.condition, item.condition_at = condition.text, condition.offset
            elif item.start is None and lex.accept("="):
                if type_ == "port":
                    lex.fail("A port has no start value", "Leave it out; data come through hal_port_write.")
                item.start = self.value()
            else:
                break
        item.doc = self.doc()
        runs = names.hash_runs(item.name)
        if item.is_array and runs == 0:
            lex.fail(f"Array name contains no #: '{item.name}'", f"Write where the number goes: {item.name}-#", name.offset)
        if not item.is_array and runs:
            lex.fail(f"Non-array name contains #: '{item.name}'", f"Say how many there are: {item.name} [4]", name.offset)
        if runs > 1:
            lex.fail(f"Array name contains more than one block of #: '{item.name}'", "There is one number in a name.", name.offset)
        if not item.c_name.strip("_") or not lexer.IDENTIFIER.fullmatch(item.c_name):
            lex.fail(f"'{item.name}' gives no name for C", "It needs letters.", name.offset)
        self.take(item.c_name, name.offset)
        self.component.items.append(item)
        self.component.order.append((kind, item))

    def on_pin(self, _):
        self.item("pin", ("in", "out", "io"))

    def on_param(self, _):
        self.item("param", ("r", "rw"))

    def on_function(self, _):
        name = self.hal_name("the function's name")
        mark = self.lex.at
        word = self.lex.match("word", lexer.IDENTIFIER)
        if word and word.text in ("fp", "nofp"):
            line, _ = self.source.place(word.offset)
            self.component.warnings.append(f"{self.source.name}:{line}: Warning: '{word.text}' is no longer supported and has no effect")
        else:
            self.lex.at = mark
        function = Function(name.text, self.doc(), name.offset)
        if "#" in name.text:
            self.lex.fail(f"Non-array name contains #: '{name.text}'", "There are no arrays of functions.", name.offset)
        self.take(function.c_name, name.offset)
        self.component.functions.append(function)
        self.component.order.append(("funct", function))

    def on_option(self, _):
        name = self.one_of(tuple(OPTIONS), "option")
        kind, lex = OPTIONS[name.text], self.lex
        if any(word == "option" and what[0] == name.text for word, what in self.component.order):
            lex.fail(f"Duplicate option {name.text}", "Each option stands once.", name.offset)
        lex.skip()
        at = lex.at
        if lex.peek(";"):
            if kind != YES:
                lex.fail(f"Option {name.text} needs {kind}", f"Write: option {name.text} VALUE;")
            value = True
        else:
            string = lex.string()
            if string:
                value, given = string.text, TEXT
            else:
                number = lex.match("number", lexer.NUMBER)
                if number:
                    value, given = number.text, NUMBER
                else:
                    # `option data struct state;`: several words.
                    words = [self.need(lex.match("name", lexer.IDENTIFIER), kind).text]
                    while kind == NAME:
                        word = lex.match("name", lexer.STARRED)
                        if word is None:
                            break
                        words.append(word.text)
                    value, given = " ".join(words), NAME
            if kind == YES:
                if value not in YES_OR_NO:
                    lex.fail(f"Option {name.text} is yes or no, not '{value}'", offset=at)
                value = YES_OR_NO[value]
            elif kind == NUMBER:
                if given != NUMBER:
                    lex.fail(f"Option {name.text} needs a number, not '{value}'", offset=at)
                value = self.whole(value, at)
            elif kind == TEXT and given != TEXT:
                lex.fail(f"Option {name.text} needs a text between quotes, not '{value}'", offset=at)
        self.component.options[name.text] = value
        self.component.order.append(("option", (name.text, value, name.offset)))

    def on_variable(self, _):
        lex, words = self.lex, []
        # The type is one word by the manual; `struct x` and `unsigned long` are welcome too.
        while True:
            token = self.need(lex.match("name", lexer.STARRED), "a type and a name",
                              "For instance: variable double old; no blank between '*' and the name.")
            words.append(token)
            lex.skip()
            if lex.text[lex.at:lex.at + 1] in (";", "[", "=", ""):
                break
        if len(words) < 2:
            lex.fail(f"Expected a name behind the type '{words[0].text}'", "For instance: variable double old;")
        if any(word.text.startswith("*") for word in words[:-1]):
            lex.fail("Expected ';' behind the variable's name", offset=words[-1].offset)
        last = words[-1]
        name = last.text.lstrip("*")
        sizes, start = [], None
        while lex.accept("["):
            # A number, or a constant of an included header.
            size = lex.match("name", lexer.IDENTIFIER)
            sizes.append(size.text if size else self.number("The size of an array", 1))
            self.sign("]")
        if lex.accept("="):
            start = self.value()
        self.doc()
        self.take(name, last.offset)
        variable = Variable(" ".join(word.text for word in words[:-1]), "*" * (len(last.text) - len(name)), name, sizes, start, last.offset)
        self.component.variables.append(variable)
        self.component.order.append(("variable", variable))

    def on_modparam(self, _):
        type_ = self.one_of(("int", "dummy"), "type of modparam").text
        name = self.need(self.lex.match("name", lexer.IDENTIFIER), "the parameter's name")
        start = self.value() if self.lex.accept("=") else "0"
        parameter = ModuleParameter(type_, name.text, start, self.doc(), name.offset)
        if type_ == "int":
            self.take(name.text, name.offset)
        self.component.modparams.append(parameter)
        self.component.order.append(("modparam", parameter))

    def on_include(self, _):
        header = self.lex.match("header", lexer.HEADER)
        if header:
            name = header.text
        else:
            string = self.need(self.lex.string(), "a header", 'Write: include <math.h>; or include "mine.h";')
            name = '"' + string.text + '"'
        self.component.includes.append(name)
        self.component.order.append(("include", name))

    def on_text(self, word):
        string = self.need(self.lex.string(), "a text between quotes")
        self.component.texts[word.text].append(string.text)
        self.component.order.append((word.text, string.text))

    # -- the whole --

    def finish(self):
        lex, comp = self.lex, self.component
        line, _ = self.source.place(lex.at)
        end = lex.text.find("\n", lex.at)
        rest = lex.text[lex.at + 2:] if end < 0 else lex.text[lex.at + 2:end]
        if rest.strip() and not rest.strip().startswith(("//", "/*")):
            lex.fail("';;' must stand on a line of its own", "The C code begins in the next line.")
        comp.body, comp.body_line = ("" if end < 0 else lex.text[end + 1:]), line + 1
        self.check()
        return comp

    def check(self):
        comp, lex = self.component, self.lex
        if not comp.texts["license"]:
            raise lexer.CompError(self.source, None, "License not specified", 'Write, for instance: license "GPL";')
        if not comp.pins:
            raise lexer.CompError(self.source, None, "Component must have at least one pin",
                                  'For instance: pin out bit is_module = 1 "Always true";')
        if comp.is_user:
            if comp.functions:
                lex.fail("Userspace components may not have functions",
                         "A program has void user_mainloop(void); remove the function or 'option userspace'.", comp.functions[0].offset)
            if not re.search(r"\buser_mainloop\b", comp.body):
                raise lexer.CompError(self.source, None, "A userspace component needs user_mainloop",
                                      "Write after ;; : void user_mainloop(void) { ... }")
        one = len(comp.functions) == 1
        if comp.functions and "FUNCTION" not in comp.body and not one and not comp.option("no_convenience_defines"):
            lex.fail("Must use FUNCTION() when more than one function is defined",
                     f"Write after ;; : FUNCTION({comp.functions[0].c_name}) {{ ... }}", comp.functions[1].offset)
        # Code in a file of its own is not looked into, nor what macros make.
        looked_into = not comp.option("no_convenience_defines") and "##" not in comp.body
        if looked_into and "FUNCTION" in comp.body and not re.search(r'^\s*#\s*include\s*"', comp.body, re.M):
            for function in comp.functions:
                if not re.search(rf"\b\w+\s*\(\s*{function.c_name}\s*\)", comp.body):
                    lex.fail(f"Function {function.name} is declared and not defined",
                             f"Write after ;; : FUNCTION({function.c_name}) {{ ... }}", function.offset)
            for option, macro in (("extra_setup", "EXTRA_SETUP"), ("extra_cleanup", "EXTRA_CLEANUP"), ("post_export", "POST_EXPORT")):
                if comp.option(option) and not re.search(rf"\b(?:{macro}|{option})\s*\(", comp.body):
                    raise lexer.CompError(self.source, None, f"Option {option} without {macro}()", f"Write after ;; : {macro}() {{ ... }}")
        if comp.option("count_function") and comp.is_singleton:
            raise lexer.CompError(self.source, None, "A singleton has no count_function", "Remove one of the two options.")
        if comp.option("data") is True:
            raise lexer.CompError(self.source, None, "Option data needs a type")
        if comp.option("cxx"):
            for item in [*comp.items, *comp.functions]:
                if item.c_name in names.CXX_WORDS:
                    lex.fail(f"Name {item.c_name} is a word of the language C++",
                             f"Write {item.name}_ : in HAL its name is the same.", item.offset)


def c_string(text):
    """As a literal of C."""
    out = []
    for byte in text.encode():
        char = chr(byte)
        if char in '"\\':
            out.append("\\" + char)
        elif char == "\n":
            out.append("\\n")
        elif 32 <= byte < 127:
            out.append(char)
        else:
            out.append(f"\\{byte:03o}")
    return '"' + "".join(out) + '"'


def parse(name, text):
    return Parser(lexer.Source(name, text)).parse()
