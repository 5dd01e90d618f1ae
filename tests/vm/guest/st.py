# SPDX-License-Identifier: Apache-2.0
"""Function blocks in Structured Text (IEC 61131-3), as far as examples/edmd.st
goes: BOOL, USINT and UINT, assignments, IF, AND OR NOT, comparisons.  All else is
refused, and so is a value that its variable cannot hold.
"""
import operator
import re

TOKEN = re.compile(r"\(\*.*?\*\)|(\d+|\w+|:=|<>|<=|>=|[()=<>;:,])|\s+|(.)", re.S)
TYPES = {"BOOL": 1, "USINT": 255, "UINT": 65535}
COMPARE = {"=": operator.eq, "<>": operator.ne, "<": operator.lt,
           ">": operator.gt, "<=": operator.le, ">=": operator.ge}
WORDS = set("IF THEN ELSIF ELSE END_IF AND OR NOT END_VAR VAR VAR_INPUT VAR_OUTPUT "
            "FUNCTION_BLOCK END_FUNCTION_BLOCK TRUE FALSE".split()) | TYPES.keys()


class Odd(Exception):
    """What is not in this language."""


class Text:
    def __init__(self, text):
        self.tokens, self.at = [], 0
        for m in TOKEN.finditer(text):
            if m[2]:
                raise Odd(f"{m[2]!r}")
            if m[1]:
                self.tokens.append(m[1])

    def peek(self):
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def take(self, *wanted):
        """The next token, if it is one of these; without any, whatever it is."""
        word = self.peek()
        if wanted and word not in wanted:
            return ""
        self.at += 1
        return word

    def need(self, *wanted):
        word = self.peek()
        if not self.take(*wanted):
            raise Odd(f"{word!r} where {' or '.join(wanted)} belongs")
        return word


class Block:
    """One of a file: its inputs are set, scan(), and its outputs are read."""

    def __init__(self, text, name):
        self.most, self.kind = {}, {}
        t = Text(text)
        while t.need("FUNCTION_BLOCK") and (found := t.take()) != name:
            while t.take() != "END_FUNCTION_BLOCK":
                if not t.peek():
                    raise Odd(f"no END_FUNCTION_BLOCK of {found}")
        while kind := t.take("VAR_INPUT", "VAR_OUTPUT", "VAR"):
            self.declare(t, kind)
        self.values = dict.fromkeys(self.most, 0)
        self.body = self.statements(t)
        t.need("END_FUNCTION_BLOCK")

    def __getitem__(self, name):
        return self.values[name]

    def __setitem__(self, name, value):
        if not 0 <= value <= self.most[name] or value != int(value):
            raise Odd(f"{name} cannot be {value}")
        self.values[name] = int(value)

    def scan(self, **inputs):
        for name, value in inputs.items():
            if self.kind[name] != "VAR_INPUT":
                raise Odd(f"{name} is no input")
            self[name] = value
        self.run(self.body)

    # -- The text ---------------------------------------------------------------

    def declare(self, t, kind):
        while not t.take("END_VAR"):
            names = [self.name(t, new=True)]
            while t.take(","):
                names.append(self.name(t, new=True))
            t.need(":")
            most = TYPES[t.need(*TYPES)]
            t.need(";")
            for name in names:
                self.most[name], self.kind[name] = most, kind

    def name(self, t, new=False):
        word = t.take()
        if not word.isidentifier() or word in WORDS or (word in self.most) == new:
            raise Odd(f"{word!r} as a name")
        return word

    def statements(self, t):
        found = []
        while t.peek() not in ("ELSIF", "ELSE", "END_IF", "END_FUNCTION_BLOCK"):
            found.append(self.choice(t) if t.take("IF") else self.assignment(t))
            t.need(";")
        return found

    def assignment(self, t):
        name = self.name(t)
        if self.kind[name] == "VAR_INPUT":
            raise Odd(f"{name} is an input")
        t.need(":=")
        return name, self.either(t)

    def choice(self, t):
        arms, word = [], "IF"
        while word != "END_IF":
            test = (lambda: 1) if word == "ELSE" else self.either(t)
            if word != "ELSE":
                t.need("THEN")
            arms.append((test, self.statements(t)))
            word = t.need("END_IF") if word == "ELSE" else \
                t.need("ELSIF", "ELSE", "END_IF")
        return None, arms

    # From what binds least to what binds most, as the standard has it.

    def either(self, t):
        a = self.both(t)
        while t.take("OR"):
            a = (lambda a, b: lambda: a() | b())(a, self.both(t))
        return a

    def both(self, t):
        a = self.comparison(t)
        while t.take("AND"):
            a = (lambda a, b: lambda: a() & b())(a, self.comparison(t))
        return a

    def comparison(self, t):
        a = self.operand(t)
        word = t.take(*COMPARE)
        if not word:
            return a
        b, test = self.operand(t), COMPARE[word]
        return lambda: int(test(a(), b()))

    def operand(self, t):
        if t.take("NOT"):
            a = self.operand(t)
            return lambda: 1 - a()
        if t.take("("):
            a = self.either(t)
            t.need(")")
            return a
        if word := t.take("TRUE", "FALSE"):
            return lambda: int(word == "TRUE")
        if t.peek().isdigit():
            value = int(t.take())
            return lambda: value
        name = self.name(t)
        return lambda: self.values[name]

    # -- A scan -----------------------------------------------------------------

    def run(self, statements):
        for name, what in statements:
            if name:
                self[name] = what()
                continue
            for test, arm in what:
                if test():
                    self.run(arm)
                    break
