"""A Component's manual page, as groff and as AsciiDoc.

The texts in .comp files are groff in the files of LinuxCNC 2.9 and AsciiDoc in newer ones. Which of the two is seen from the text;
the other format gets the nearest that it has."""
import re

from . import names


def is_groff(text):
    return bool(re.search(r"\\f[BIRP1-4]|\\-|\\\(bu|^\.[A-Za-z]{1,2}\b", text, re.M))


# -- inline marks --

def groff_of_adoc(text):
    text = text.replace("\\", "\\e")
    text = re.sub(r"(?<![\w*])\*\*?(\S(?:[^*\n]*\S)?)\*\*?(?![\w*])", r"\\fB\1\\fR", text)
    text = re.sub(r"(?<![\w_])__?(\S(?:[^_\n]*\S)?)__?(?![\w_])", r"\\fI\1\\fR", text)
    return re.sub(r"`([^`\n]+)`", r"\\fB\1\\fR", text)


def groff_text(text):
    """A text of several paragraphs as groff."""
    if is_groff(text):
        return text.strip("\n")
    out, listing = [], False
    for line in text.strip("\n").split("\n"):
        stripped = line.strip()
        if stripped in ("----", "...."):
            out.append(".fi" if listing else ".nf")
            listing = not listing
            continue
        if listing:
            out.append(guard(line.replace("\\", "\\e")))
            continue
        mark = re.match(r"\s*(\*+|-|\.)\s+(.*)", line)
        term = re.match(r"(\S.*?)::\s*(.*)$", stripped)
        if not stripped:
            if out and out[-1] != ".PP":
                out.append(".PP")
        elif stripped in ("+",) or stripped.startswith("["):
            continue
        elif mark:
            out += [r".IP \(bu 4", guard(groff_of_adoc(mark[2]))]
        elif term:
            out += [".TP", guard(groff_of_adoc(term[1]))] + ([guard(groff_of_adoc(term[2]))] if term[2] else [])
        elif stripped.startswith("=="):
            out.append(f'.SS "{stripped.lstrip("= ")}"')
        else:
            out.append(guard(groff_of_adoc(stripped)))
    return "\n".join(out)


def guard(line):
    """A text line that begins like a request."""
    return "\\&" + line if line.startswith((".", "'")) else line


def adoc_text(text):
    if not is_groff(text):
        return text.strip("\n")
    out = []
    literal = False
    for line in text.strip("\n").split("\n"):
        request = re.match(r"\.([A-Za-z]+)\s*(.*)", line)
        if request and request[1] in ("PP", "P", "LP", "sp"):
            out.append("")
        elif request and request[1] in ("nf", "EX", "fi", "EE"):
            literal = request[1] in ("nf", "EX")
            out.append("----")
        elif request and request[1] == "IP":
            out.append("* \\")
        elif request and request[1] in ("B", "I"):
            mark = "*" if request[1] == "B" else "_"
            out.append(f"{mark}{request[2].strip(chr(34))}{mark}")
        elif request and request[1] in ("SS", "SH"):
            out += ["", "=== " + request[2].strip('"')]
        elif request:
            continue
        else:
            if not literal:
                line = re.sub(r"\\fB(.*?)\\f[RP]", r"*\1*", line)
                line = re.sub(r"\\fI(.*?)\\f[RPB]", r"_\1_", line)
            line = re.sub(r"\\f[BIRP]|\\&", "", line).replace("\\-", "-").replace("\\(bu", "*").replace("\\e", "\\")
            if out and out[-1] == "* \\":
                out[-1] = "* " + line
            else:
                out.append(line)
    return "\n".join(out)


# -- what both say --

def item_name(comp, item):
    """(words before the number, the letter of an array's number, words behind)"""
    prefix = comp.hal_name + ("" if comp.is_singleton else ".\0N\1")
    name = names.to_hal(item.name)
    if item.is_array:
        run = re.search("#+", name).group()
        name = name.replace(run, "\0" + "M" * len(run) + "\1")
    return f"{prefix}.{name}"


def function_name(comp, function):
    prefix = comp.hal_name + ("" if comp.is_singleton else ".\0N\1")
    name = names.to_hal(function.name)
    return prefix + ("." + name if name else "")


def span(item):
    """The numbers of an array: M=0..3"""
    if not item.is_array:
        return ""
    run = re.search("#+", item.name).group()
    width = len(run) if len(run) > 1 else 0
    last = f"{item.size - 1:0{width}d}"
    if item.used:
        last = f"{item.used} - 1" if re.fullmatch(r"\w+|\([^()]*\)", item.used) else f"({item.used}) - 1"
    return f" ({'M' * len(run)}={0:0{width}d}..{last})"


def synopsis(comp):
    """Words of the loadrt line, with \0..\1 around what the user replaces and \2..\3 around what is written as it stands."""
    if comp.option("homemod"):
        return f"Custom Homing module loaded with \2[EMCMOT]HOMEMOD={comp.name}\3"
    if comp.option("tpmod"):
        return f"Custom Trajectory Planning module loaded with \2[TRAJ]TPMOD={comp.name}\3"
    words = f"\2loadusr {comp.name}\3" if comp.is_user else f"\2loadrt {comp.name}\3"
    if not comp.is_singleton:
        choices = [] if comp.option("count_function") else ["\2count=\3\0N\1"]
        choices.append("\2names=\3\0name1\1[,\0name2...\1]")
        words += " [" + "|".join(choices) + "]"
    if comp.has_personality:
        words += " [\2personality=\3\0P1\1[,\0P2...\1]]"
    for parameter in comp.modparams:
        words += f" [\2{parameter.name}=\3\0N\1]"
    return words


def sections(comp):
    """(title, list of (term or None, text)) in the order of the page; marks as in synopsis()."""
    first = comp.doc.strip().split("\n")[0]
    out = [("NAME", [(None, f"{comp.name} - {first}" if first else comp.name)]), ("SYNOPSIS", [(None, synopsis(comp))])]
    known = [(f"\2{p.name}\3" + (f" (default: \0{p.start}\1)" if p.type == "int" else ""), p.doc) for p in comp.modparams if p.doc]
    out[-1][1].extend(known)
    rest = "\n".join(comp.doc.strip().split("\n")[1:]).strip("\n")
    texts = ([rest] if rest else []) + comp.texts["description"]
    if texts:
        out.append(("DESCRIPTION", [(None, text) for text in texts]))
    if comp.functions:
        out.append(("FUNCTIONS", [(f"\2{function_name(comp, f)}\3", f.doc) for f in comp.functions]))
    for title, items in (("PINS", comp.pins), ("PARAMETERS", comp.params)):
        if items:
            out.append((title, [(item_term(comp, item), item.doc) for item in items]))
    for kind, title in (("examples", "EXAMPLES"), ("see_also", "SEE ALSO"), ("notes", "NOTES"), ("author", "AUTHOR"), ("license", "LICENSE")):
        if comp.texts[kind]:
            out.append((title, [(None, text) for text in comp.texts[kind]]))
    return out


def item_term(comp, item):
    kind = {"signed": "s32", "unsigned": "u32"}.get(item.type, item.type)  # old words for what HAL shows as these
    term = f"\2{item_name(comp, item)}\3 {kind} {item.dir}{span(item)}"
    if item.condition:
        term += f" [if {item.condition}]"
    if item.start is not None:
        term += f" (default: \0{item.start}\1)"
    return term


# -- the two formats --

def marks_groff(text):
    # Inside of bold text, what is to be replaced is italic, and bold goes on behind it.
    out, bold = [], False
    for char in text:
        if char == "\2":
            bold = True
            out.append("\\fB")
        elif char == "\3":
            bold = False
            out.append("\\fR")
        elif char == "\0":
            out.append("\\fI")
        elif char == "\1":
            out.append("\\fB" if bold else "\\fR")
        else:
            out.append({"\\": "\\e", "-": "\\-"}.get(char, char))
    return "".join(out)


def marks_adoc(text):
    text = re.sub("\0([^\1]*)\1", r"_\1_", text)
    return re.sub("\2([^\3]*)\3", r"*\1*", text)


def section_number(comp):
    return "1" if comp.is_user else "9"


def to_groff(comp):
    out = [f'.\\" Made by halcompile from {comp.source.name}; changes here are lost.',
           f'.TH {comp.name.upper()} "{section_number(comp)}" "" "Kerf" "HAL Component"']
    for title, entries in sections(comp):
        out.append(f'.SH "{title}"' if " " in title else f".SH {title}")
        for index, (term, text) in enumerate(entries):
            if title == "NAME":
                name, _, what = text.partition(" - ")
                out.append(f"{name} \\- {groff_text(what)}" if what else name)
            elif title == "SYNOPSIS" and term is None:
                out.append(guard(marks_groff(text)))
            elif term is None:
                out += [".PP"] * (index > 0) + [groff_text(text)]
            else:
                out += [".TP", guard(marks_groff(term)), groff_text(text) if text.strip() else "\\&"]
    return "\n".join(out) + "\n"


def to_adoc(comp):
    out = [f"// Made by halcompile from {comp.source.name}; changes here are lost.", f"= {comp.name.upper()}({section_number(comp)})", ":manmanual: HAL Component",
           ":mansource: Kerf", ""]
    for title, entries in sections(comp):
        out += [f"== {title}", ""]
        for term, text in entries:
            if title in ("NAME", "SYNOPSIS") and term is None:
                out += [marks_adoc(text) if title == "SYNOPSIS" else adoc_text(text), ""]
            elif term is None:
                out += [adoc_text(text), ""]
            else:
                out += [marks_adoc(term) + "::"] + ([adoc_text(text)] if text.strip() else ["{empty}"])
        out.append("")
    return re.sub(r"\n{3,}", "\n\n", "\n".join(out)).rstrip("\n") + "\n"
