"""halcompile: the .comp language, and the compiler's calls. The manual is halcompile(1).

lexer -> syntax (a Component) -> emit (C) -> build (gcc)
                              -> document (man page, AsciiDoc)
"""
