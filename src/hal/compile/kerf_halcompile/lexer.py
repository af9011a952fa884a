"""Words of the declaration part of a .comp file. What a word may look like depends on where it stands: `a-1` is a HAL name
behind `pin in bit` and an expression behind `if`. So the parser asks for the kind that it wants."""
import dataclasses
import re


class CompError(Exception):
    """What is wrong, where, and what to do."""

    def __init__(self, source, offset, what, hint=""):
        super().__init__(what)
        self.source, self.offset, self.what, self.hint = source, offset, what, hint

    def text(self):
        if self.offset is None:
            lines = [f"{self.source.name}:0: {self.what}"]
        else:
            line, column = self.source.place(self.offset)
            shown = self.source.line_text(line).expandtabs(1)
            lines = [f"{self.source.name}:{line}:{column}: {self.what}", f">  {shown}", ">  " + " " * (column - 1) + "^"]
        return "\n".join(lines + ([f"   {self.hint}"] if self.hint else []))


class Source:
    def __init__(self, name, text):
        self.name, self.text = name, text

    def place(self, offset):
        before = self.text[:offset]
        return before.count("\n") + 1, offset - (before.rfind("\n") + 1) + 1

    def line_text(self, line):
        lines = self.text.split("\n")
        return lines[line - 1].rstrip("\r") if line <= len(lines) else ""


@dataclasses.dataclass
class Token:
    kind: str
    text: str
    offset: int


IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
HAL_NAME = re.compile(r"[#A-Za-z_][-#A-Za-z0-9_.]*")
NUMBER = re.compile(r"[-+]?(?:0[xX][0-9A-Fa-f]+|0[bB][01]+|0[oO][0-7]+|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)[uUlLfF]*")
STARRED = re.compile(r"\**[A-Za-z_][A-Za-z0-9_]*")
HEADER = re.compile(r"<[^>\n]*>")
# An operator or anything else that may stand in an expression of C.
C_PIECE = re.compile(r"""[A-Za-z_]\w*|0[xX][0-9A-Fa-f]+[uUlL]*|0[bB][01]+|\d+(?:\.\d*)?(?:[eE][-+]?\d+)?[uUlLfF]*|'(?:\\.|[^'\\])'
                         |<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%<>!~&|^?:().,]""", re.X)
ESCAPES = {"n": "\n", "t": "\t", "r": "\r", "a": "\a", "b": "\b", "f": "\f", "v": "\v", "\\": "\\", '"': '"', "'": "'", "\n": ""}


class Lexer:
    def __init__(self, source):
        self.source, self.text, self.at = source, source.text, 0

    def fail(self, what, hint="", offset=None):
        raise CompError(self.source, self.at if offset is None else offset, what, hint)

    def skip(self):
        """Blanks and comments."""
        while True:
            match = re.compile(r"\s+").match(self.text, self.at)
            if match:
                self.at = match.end()
            elif self.text.startswith("//", self.at):
                end = self.text.find("\n", self.at)
                self.at = len(self.text) if end < 0 else end
            elif self.text.startswith("/*", self.at):
                end = self.text.find("*/", self.at + 2)
                if end < 0:
                    self.fail("Comment without end", "Close it with */.")
                self.at = end + 2
            else:
                return

    def peek(self, text):
        self.skip()
        return self.text.startswith(text, self.at)

    def accept(self, text):
        """A sign, or a word that ends here."""
        if not self.peek(text):
            return False
        if text[-1].isalnum() and re.compile(r"[\w-]").match(self.text, self.at + len(text)):
            return False
        self.at += len(text)
        return True

    def match(self, kind, pattern):
        self.skip()
        found = pattern.match(self.text, self.at)
        if not found:
            return None
        token = Token(kind, found.group(), self.at)
        self.at = found.end()
        return token

    def shown(self):
        """What stands here, for messages."""
        self.skip()
        if self.at >= len(self.text):
            return "the end of the file"
        return "'" + re.compile(r"[\w#.-]+|.", re.S).match(self.text, self.at).group() + "'"

    def string(self):
        """A text as C or Python write it, or None."""
        self.skip()
        begin = self.at
        raw = self.text.startswith(('r"', 'R"'), begin)
        at = begin + raw
        if not self.text.startswith('"', at):
            return None
        quote = '"""' if self.text.startswith('"""', at) else '"'
        at += len(quote)
        out = []
        while True:
            if at >= len(self.text) or (quote == '"' and self.text[at] == "\n"):
                self.fail("Text without end", f"Close it with {quote}; texts of several lines stand between three quotes.", begin)
            if self.text.startswith(quote, at):
                self.at = at + len(quote)
                return Token("string", "".join(out), begin)
            if self.text[at] == "\\" and at + 1 < len(self.text):
                following = self.text[at + 1]
                if raw:
                    out.append("\\" + following)
                    at += 2
                elif following == "x" or following in "01234567":
                    number = re.compile(r"x([0-9A-Fa-f]{1,2})|([0-7]{1,3})").match(self.text, at + 1)
                    if not number:
                        self.fail("'\\x' without digits", "Write \\\\x for the characters themselves.", at)
                    out.append(chr(int(number[1], 16) if number[1] else int(number[2], 8)))
                    at = number.end()
                else:
                    out.append(ESCAPES.get(following, "\\" + following))
                    at += 2
                continue
            out.append(self.text[at])
            at += 1

    def expression(self, ends):
        """An expression of C up to one of the signs `ends` outside of parentheses, or a text."""
        self.skip()
        begin, depth, pieces = self.at, 0, []
        while True:
            self.skip()
            if self.at >= len(self.text):
                self.fail("Expression without end", offset=begin)
            here = self.text[self.at]
            if depth == 0 and (here == '"' or self.text.startswith('r"', self.at) or
                               (here in ends and not self.text.startswith("==", self.at))):
                break
            piece = self.match("piece", C_PIECE)
            if piece is None:
                self.fail(f"{self.shown()} cannot stand in an expression",
                          "Expressions are those of C, of numbers and personality.")
            depth += {"(": 1, ")": -1}.get(piece.text, 0)
            if depth < 0:
                self.fail("')' without '('", offset=piece.offset)
            pieces.append(piece.text)
        if not pieces:
            self.fail("Expression missing", "For instance: personality & 0xff")
        if depth:
            self.fail("'(' without ')'", offset=begin)
        return Token("expression", " ".join(pieces), begin)
