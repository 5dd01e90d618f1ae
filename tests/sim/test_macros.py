# SPDX-License-Identifier: Apache-2.0
"""Variables, expressions and jumps: against LinuxCNC's own interpreter, and
against the same program written out line by line.
"""
import math
import os
import re
import subprocess

import pytest
from edmsim import HANGS_S, PROGRAM, ROOT, done, run, seeded
from rs274 import canonical_calls, peer

MACROS = ROOT / "tests/data/macros"


def theirs(path, tmp_path):
    """Ends of LinuxCNC's motions, X Y Z A B C."""
    copy = tmp_path / "theirs.ngc"
    copy.write_bytes(path.read_bytes())
    return [tuple(float(n) for n in m.split(", ")) for m in re.findall(
        r"STRAIGHT_(?:TRAVERSE|FEED)\((.*?)\)", canonical_calls(copy))]


def ours(path, dialect):
    """The same, of what edmsim reads; words that do not change are missing."""
    out = subprocess.run([PROGRAM, "--dialect", dialect, "--emit", "iso",
                          str(path)], capture_output=True, text=True,
                         timeout=HANGS_S)
    assert out.returncode == 0, out.stderr
    at, ends = [0.0] * 6, []
    for line in out.stdout.splitlines():
        words = re.findall(r"([XYZABC])(-?[\d.]+)", line)
        for letter, value in words:
            at["XYZABC".index(letter)] = float(value)
        if words:
            ends.append(tuple(at))
    return ends


def moved(ends):
    """Without motions that go nowhere."""
    ret, at = [], (0.0,) * 6
    for end in ends:
        if max(map(abs, map(float.__sub__, end, at))) > 1e-4:
            ret.append(end)
            at = end
    return ret


def assert_same(path, tmp_path, other=None):
    """@other: the same program, in words of every version of LinuxCNC."""
    a = moved(ours(path, "linuxcnc"))
    b = moved(theirs(other or path, tmp_path))
    assert len(a) == len(b) and a, (len(a), len(b))
    for mine, other in zip(a, b):
        assert all(math.isclose(m, o, abs_tol=1.01e-3)
                   for m, o in zip(mine, other)), (mine, other)


@peer
@pytest.mark.parametrize("name", ["linuxcnc.ngc", "cavities.ngc"])
def test_o_words_end_where_linuxcnc_ends(name, tmp_path):
    assert_same(MACROS / name, tmp_path)


def expression(rnd, depth):
    """A random one that both read, without values that are no numbers."""
    if depth == 0 or rnd.random() < 0.2:
        return rnd.choice([f"{rnd.uniform(-9, 9):.3f}", "#1", "#2", "#<a>"])
    a, b = expression(rnd, depth - 1), expression(rnd, depth - 1)
    kind = rnd.randrange(6)
    if kind == 0:
        f = rnd.choice(["sin", "cos", "abs", "fix", "fup", "round", "atan"])
        return f"atan[{a}]/[{b}]" if f == "atan" else f"{f}[{a}]"
    if kind == 1:
        return f"sqrt[abs[{a}]]"
    if kind == 2:
        return f"[{a} / [abs[{b}] + 1]]"
    if kind == 3:
        return f"[{a} {rnd.choice(['lt', 'ge', 'and', 'xor', 'or'])} {b}]"
    if kind == 4:
        return f"[[{a}] mod [abs[{b}] + 1]]"
    return f"[{a} {rnd.choice('+-')} {b} * {expression(rnd, depth - 1)}]"


@peer
def test_random_expressions_come_to_what_linuxcnc_says(tmp_path):
    rnd = seeded()
    lines = ["G21 G90", "#1=2.5 #2=-1.25 #<a>=7"]
    for i in range(60):
        # Within the travel, wherever it comes to.  Y moves on each line: two
        # values of X in a row may be equal for one of the two alone, who
        # writes fewer decimals.
        lines.append(f"G0 X[50 * sin[{expression(rnd, 3)}]] Y{i % 2 + 1}")
        # Plus a number that is far from a whole one: 7 MOD [1 + 3e-16] and 7 MOD 1
        # are not alike, and who writes cos[90] as 6e-17 would be told apart.
        lines.append(f"#{rnd.choice([1, 2])} = "
                     f"[5 * cos[{expression(rnd, 2)}] + 0.1371]")
    path = tmp_path / "e.ngc"
    path.write_text("\n".join(lines) + "\nM2\n")
    assert_same(path, tmp_path)


def test_a_whole_number_by_rule_is_whole(tmp_path):
    """Though pi and a 180th of it are rounded in a computer."""
    whole = {"fix[2 * sin[30]]": 1, "fix[2 * cos[60]]": 1, "fup[2 * sin[150]]": 1,
             "fix[tan[45]]": 1, "fup[cos[90]]": 0, "fup[sin[-180]]": 0,
             "fix[sin[360000000]]": 0, "fix[asin[0.5]]": 30, "fup[acos[0.5]]": 60,
             "fix[atan[1]/[1]]": 45, "fup[atan[sin[180]]/[-1]]": 180,
             "7 mod [abs[5 * cos[90]] + 1]": 0}
    lines = [f"G0 X[{e}] Y{i + 1}" for i, e in enumerate(whole)]
    path = tmp_path / "e.ngc"
    path.write_text("\n".join(["G21 G90"] + lines) + "\nM2\n")
    assert [e[0] for e in ours(path, "linuxcnc")] == list(whole.values())


@peer
def test_what_is_nearly_equal_is_equal_as_in_linuxcnc(tmp_path):
    """Since 2.9.4 GE and LE are true where EQ is; before, they were exact.  What
    is nearly equal was 0.0001, and is 0.000001."""
    def compare(word, a, b):
        mine = other = f"[{a} {word} {b}]"
        if word in ("GE", "LE"):
            other = f"[[{a} EQ {b}] OR [{a} {word[0]}T {b}]]"
        return f"G0 X[2 + {mine}]", f"G0 X[2 + {other}]"

    lines = [], []
    for i, off in enumerate(("0", "0.00000001", "0.0000009", "0.00011", "0.001")):
        for word in ("EQ", "NE", "GT", "GE", "LT", "LE"):
            for y, of in ((i, ("3", f"[3 + {off}]")), (i + 9, (f"[3 + {off}]", "3"))):
                for k, line in enumerate(compare(word, *of)):
                    lines[k].append(f"{line} Y{y}")
    mine, other = (written(tmp_path / f"{k}.ngc", lines[k]) for k in (0, 1))
    assert_same(mine, tmp_path, other)


def written(path, lines):
    path.write_text("\n".join(["G21 G90", *lines]) + "\nM2\n")
    return path


class Words:
    """A random program of O words, with the layout in which rs274 takes it."""

    def __init__(self, rnd):
        self.rnd = rnd
        self.names = 0
        self.depth = 0
        self.lines = ["G21 G90", "#1=1 #2=2 #<_n>=0"]
        self.subs = []

    def name(self):
        self.names += 1
        return self.rnd.choice([f"{self.names}00", f"<loop_{self.names}>"])

    def noise(self, *tokens, comments=99):
        """Upper and lower case, blanks and tabs, and comments where rs274 has them:
        behind so many tokens."""
        rnd, ret = self.rnd, rnd_blank(self.rnd)
        for i, t in enumerate(tokens):
            ret += "".join(rnd.choice([c.upper(), c.lower()]) for c in t)
            ret += rnd_blank(rnd)
            if i >= comments and rnd.random() < 0.4:
                ret += rnd.choice(["(length)", "( X9 [7] )", "(o1 if)"])
        self.lines.append(ret + rnd.choice(["", "", "(end)", "; [2] X5"]))
        for _ in range(rnd.randrange(-3, 3)):
            self.lines.append(rnd.choice(["", "  ", "(a line)", "; another"]))

    def expression(self):
        return expression(self.rnd, 1).replace("#<a>", "#<_n>")

    def truth(self):
        return f"[{self.expression()} {self.rnd.choice(['lt', 'ge'])} " \
               f"{self.expression()}]"

    def move(self):
        self.noise("G0", f"X[5*sin[{self.expression()}]]", "Y[#<_n>]")
        self.noise("#<_n>=[#<_n>+1]")

    def block(self):
        """Without break and continue: rs274 keeps what it knows of them, and carries
        out a later loop once too often or too seldom.  They have a test of their
        own."""
        self.depth += 1
        for _ in range(self.rnd.randint(1, 3)):
            kinds = [self.move, self.move]
            if self.depth < 4:
                kinds += [self.if_, self.while_, self.do, self.repeat, self.call]
            self.rnd.choice(kinds)()
        self.depth -= 1

    def if_(self):
        o = self.name()
        self.noise("o", o, "if", self.truth())
        self.block()
        for _ in range(self.rnd.randrange(3)):
            self.noise("o", o, "elseif", self.truth())
            self.block()
        if self.rnd.random() < 0.5:
            self.noise("o", o, "else")
            self.block()
        self.noise("o", o, "endif")

    def counted(self):
        i = f"#<_i{self.names}>"
        self.noise(f"{i}=0")
        return f"{i}=[{i}+1]", f"[{i} lt {self.rnd.randrange(4)}]"

    def while_(self):
        o = self.name()
        step, truth = self.counted()
        self.noise("o", o, "while", truth)
        self.noise(step)
        self.block()
        self.noise("o", o, "endwhile")

    def do(self):
        o = self.name()
        step, truth = self.counted()
        self.noise("o", o, "do")
        self.noise(step)
        self.block()
        self.noise("o", o, "while", truth)

    def repeat(self):
        o = self.name()
        self.noise("o", o, "repeat", f"[{self.rnd.randrange(4)}]")
        self.block()
        self.noise("o", o, "endrepeat")

    def call(self):
        o = self.name()
        args = [f"[{self.expression()}]" for _ in range(self.rnd.randrange(5))]
        self.noise("o", o, "call", *args, comments=2)
        self.noise("G0", "X[5*sin[#<_value>]]", "Y[#<_n>+0.5]")
        self.subs.append((o, self.depth))

    def sub(self, o):
        self.noise("o", o, "sub")
        for i in self.rnd.sample(range(1, 6), 3):
            self.noise("G0", f"X[5*sin[#{i}]]", f"Y[#<_n>+{i}]")
        self.block()
        if self.rnd.random() < 0.5:
            q = self.name()
            self.noise("o", q, "if", self.truth())
            self.noise("o", o, "return", f"[{self.expression()}]")
            self.noise("o", q, "endif")
        self.noise("o", o, "endsub", f"[{self.expression()}]")

    def write(self):
        self.move()
        self.block()
        self.noise("G0", "X1", "Y-1")
        main, self.lines = self.lines, []
        begin = []
        while self.subs:
            o, self.depth = self.subs.pop()
            self.lines = []
            self.sub(o)
            begin = self.lines + begin
        return "\n".join(main[:2] + begin + main[2:] + ["M2", ""])


@peer
@pytest.mark.parametrize("word", ["break", "continue"])
@pytest.mark.parametrize("begin, end", [
    ("while [#1 lt 4]", "endwhile"), ("do", "while [#1 lt 4]")])
def test_break_and_continue_go_where_linuxcnc_goes(word, begin, end, tmp_path):
    path = tmp_path / "b.ngc"
    path.write_text(f"G21 G90\n#1=0\no1 {begin}\n#1=[#1+1]\nG0 X[#1]\n"
                    f"o2 if [#1 eq 2]\no1 {word}\no2 endif\nG0 Y[#1]\no1 {end}\n"
                    "G0 Z-1\nM2\n")
    assert_same(path, tmp_path)


def rnd_blank(rnd):
    return rnd.choice(["", "", " ", "  ", "\t"])


@peer
def test_random_o_words_end_where_linuxcnc_ends_in_any_layout(tmp_path):
    """EDM_RUNS says how many."""
    rnd = seeded()
    for i in range(int(os.environ.get("EDM_RUNS", 40))):
        path = tmp_path / f"{i}.ngc"
        path.write_text(Words(rnd).write())
        assert_same(path, tmp_path)


@pytest.mark.parametrize("dialect", ["linuxcnc", "heekscnc", "fanuc-sinker",
                                     "makino"])
def test_a_line_with_a_variable_may_begin_a_program(dialect):
    """It is read in a buffer that the next line uses again."""
    o = "O1 #5=#5+1" if dialect in ("fanuc-sinker", "makino") else "O1"
    machine = ROOT / ("examples/wire.ini" if dialect == "makino" else
                      "examples/machine.ini")
    times = "M98 P20001" if dialect == "makino" else "M98 P1 L2"
    rows = done("--machine", machine, "--dialect", dialect, "--emit", "iso",
                text=f"G90\n{times}\nM30\n{o}\nG91 G0 X1.\nM99\n"
                "N1 G0 X9.\n").stdout.decode()
    assert re.findall(r"X(\S+)", rows) == ["1", "2"]


def test_the_same_with_two_megabytes_of_text():
    text = "G90\nG65 P1 L2 A1.\nM30\n" + "(filled up)\n" * 170000 + \
        "O1 #2=#1\nG91 G0 X#2\nM99\n"
    assert emitted(text) == ["X1", "X2"]


def test_a_program_has_a_name_and_a_tape_its_leaders():
    """NUL and DC2 in front, DC4 and NUL behind; a title behind the %."""
    text = "\0\0\x12%  PART-7 (REV 2)\n<PART-7>\nG90 M98 <sub_1> L2\n" \
        "G65 <SUB_1> L2 A3.\nM30\n<Sub_1> (two)\nG91 G0 X[1+#1]\nM99\n" \
        "%\nG0 X99.\n\x14\0\0"
    assert emitted(text) == ["X1", "X2", "X6", "X10"]
    r = run("--dialect", "fanuc-sinker", "--check", text=text)
    assert r.returncode == 0 and b":1: note: % begins the text" in r.stderr


def test_a_comment_may_stand_wherever_a_blank_may():
    plain = "N5 IF [#1 LT 2] GOTO 7\nX9.\nN7 WHILE [#1 LT 2] DO1\n#1=#1+1\n" \
        "X[#1*2]\nEND1\nM30\n"
    noisy = "(a) N5 (b) IF (c) [#1 (d) LT (e) 2 (f)] (g) GOTO (h) 7 (i)\nX9.\n" \
        "(j) N7 WHILE (k) [#1 LT 2] (l) DO (m) 1\n#1 (n) = (o) #1 (p) + 1\n" \
        "X[#1 (q) * 2]\n(r) END (s) 1\nM30\n"
    head = "G90 G21 G0\n#1=0\n"
    assert emitted(head + plain) == emitted(head + noisy) == ["X2", "X4"]


@peer
def test_the_places_of_linuxcnc_have_names(tmp_path):
    path = tmp_path / "p.ngc"
    path.write_text("G21 G90\nG0 X3 Y4 Z-1\nG0 X[#<_y>+#<_z>] Y[#<_X>*2]\n"
                    "G92 X1\nG0 Y[#<_x>]\nM2\n")
    assert ours(path, "linuxcnc")[-1][:3] == (3, 1, -1)
    path.write_text("G21 G90\nG0 X3 Y4 Z-1\nG0 X[#<_y>+#<_z>] Y[#<_X>*2]\n"
                    "M2\n")
    assert_same(path, tmp_path)


def written_out(text, tmp_path):
    path = tmp_path / "out.nc"
    path.write_text(text)
    return ours(path, "generic")


def test_custom_macro_b_ends_where_it_does_written_out(tmp_path):
    assert ours(MACROS / "fanuc.nc", "fanuc-sinker") == written_out(
        "G0 X10 Y.5\nG0 X20 Y1\nG0 X30 Y1.5\nG0 Z4\nG0 X7.5\nM2\n", tmp_path)


def test_a_bolt_circle_ends_where_it_does_written_out(tmp_path):
    """Arguments, loops, GOTO out of a loop, #100 shared, locals apart."""
    path = tmp_path / "bolts.nc"
    path.write_text("""O1
G90 G21
#100=0
#1=99
G65 P9010 X10. Y-5. R25. A30. H7
IF [#1 NE 99] THEN #3000=1(LOCALS)
IF [#100 NE 6] THEN #3000=2(COUNT)
M30
O9010 (#24 #25 centre, #18 radius, #1 first angle, #11 holes)
#2=0
WHILE [1 EQ 1] DO1
IF [#2 GE #11] GOTO 90
IF [#2 EQ 3] GOTO 80
G0 X[#24+#18*COS[#1+#2*360/#11]] Y[#25+#18*SIN[#1+#2*360/#11]]
G65 P9020 Z-2.
#100=#100+1
N80 #2=#2+1
END1
N90 M99
O9020
#24=#26/2
G0 Z#24
G0 Z0
M99
""")
    text = "G21 G90\n"
    for i in range(7):
        if i == 3:
            continue
        a = math.radians(30 + i * 360 / 7)
        text += f"G0 X{10 + 25 * math.cos(a):.6f} Y{-5 + 25 * math.sin(a):.6f}\n"
        text += "G0 Z-1\nG0 Z0\n"
    assert ours(path, "fanuc-sinker") == written_out(text, tmp_path)


REFUSED = [
    ("fanuc-sinker", "#1=1\nWHILE[#1 EQ 1]DO2\nG0 X1.\nEND2\nM30\n",
     b":4:1: error: a loop that has gone on for 1000000 rounds; loops"),
    ("fanuc-sinker", "N1 G0 X1.\nGOTO 1\n", b":2:1: error: a loop that has"),
    ("fanuc-sinker", "G0 X1.\nGOTO 7\n", b":2:1: error: GOTO 7, which is not"),
    ("fanuc-sinker", "G0 X[1/0]\n", b":1:7: error: a division by 0; a divisor"),
    ("fanuc-sinker", "G0 X[1+2] Y[400]\n", b":1:11: error: Y 400.0000 is bey"),
    ("fanuc-sinker", "G0 X[SQRT[-4]]\n", b":1:6: error: SQRT[-4]; a value"),
    ("fanuc-sinker", "G0 X[1+[2]\n", b":1:11: error: an expression without"),
    ("fanuc-sinker", "#3000=5\n", b":1:1: error: the program's own alarm"),
    ("fanuc-sinker", "#200=5\n", b":1:1: error: a value for #200; #1 ..."),
    ("fanuc-sinker", "G0 X#4102\n", b":1:5: error: variable #4102, whose"),
    ("fanuc-sinker", "WHILE[1 EQ 2]DO1\nG0 X1.\n", b":1:1: error: a WHILE with"),
    ("fanuc-sinker", "IF[1 EQ 2] G0 X1.\n", b":1:12: error: an IF without"),
    ("fanuc-sinker", "G65 P77 X1.\nM30\n", b":1:1: error: a call of O77"),
    ("fanuc-sinker", "O5\nG65 P5\nM30\n", b":2:1: error: a call inside 8 oth"),
    ("fanuc-sinker", "N1 G0 X1.\nM99 P1\n", b":2:5: error: a loop that has"),
    ("fanuc-sinker", "M98 P2\nM30\nO2\nN7\nM99 P7\n",
     b":1:5: error: M99 P7, which is not"),
    ("fanuc-sinker", "M98 P2 L3\nN5 M30\nO2\nM99 P5\n",
     b":4:5: error: M99 P with 2 times still to go; a call without L"),
    ("fanuc-sinker", "M99 P1.5\n", b":1:5: error: M99 P1.5; the number of"),
    ("fanuc-sinker", "G65 P1 A90 X5.\nM30\nO1\nG0 X#24\nM99\n",
     b":1:8: error: A90 without a decimal point"),
    ("fanuc-sinker", "IF[1 EQ 1]GOTO5 X3.\nN5 M30\n",
     b":1:17: error: words behind a jump, a loop or a call; them on a line"),
    ("fanuc-sinker", "WHILE[#1 LT 1]DO1 (a) X5.\n#1=1\nEND1\nM30\n",
     b":1:23: error: words behind a jump"),
    ("fanuc-sinker", "PCLOS G1 X5.\n", b":1:7: error: words behind a jump"),
    ("fanuc-sinker", "DPRNT[A[1]] X5.\n", b":1:13: error: words behind a j"),
    ("fanuc-sinker", "DPRNT[A[1] X5.\n", b":1:6: error: a DPRNT or BPRNT wit"),
    ("fanuc-sinker", "BPRNTG1 X5.\n", b":1:6: error: a DPRNT or BPRNT with"),
    ("fanuc-sinker", "#1=5" + " " * 4092 + "GG1 X5.\n",
     b":1:4097: error: a line longer than 4096 bytes"),
    ("fanuc-sinker", "IF[1 EQ 1]THEN #1=1; #2=3\n",
     b":1:22: error: words behind a jump"),
    ("linuxcnc", "o1 if [1 EQ 1] (a) G0 X5\no1 endif\n",
     b":1:20: error: words behind a jump"),
    ("linuxcnc", "o1 call [1] [2] 3\nM2\no1 sub\no1 endsub\n",
     b":1:17: error: words behind a jump"),
    ("linuxcnc", "o1 repeat [2] X7\no1 endrepeat\n",
     b":1:15: error: words behind a jump"),
    ("linuxcnc", "o1 if [1 EQ 1] [1 EQ 0]\no1 endif\n",
     b":1:16: error: words behind a jump"),
    ("linuxcnc", "o1 repeat [2] (n) [3]\no1 endrepeat\n",
     b":1:19: error: words behind a jump"),
    ("linuxcnc", "o1 if [0]\no1 elseif [1] [0]\no1 endif\n",
     b":2:15: error: words behind a jump"),
    ("linuxcnc", "o1 while [0]\no1 endwhile [1]\no1 sub [2]\no1 endsub\n",
     b":3:8: error: words behind a jump"),
    ("linuxcnc", "o1 call [1] (a) [2] (b) X3\nM2\no1 sub\no1 endsub\n",
     b":1:25: error: words behind a jump"),
    ("fanuc-sinker", "IF[1 EQ 2]GOTO 5 X3.\nN5 M30\n",
     b":1:18: error: words behind a jump"),
    ("fanuc-sinker", "IF[1 EQ 2]THEN #1=5 #2=6\nM30\n",
     b":1:21: error: words behind a jump"),
    ("fanuc-sinker", "%\nGOTO 5\n%\nN5 X2.\nM30\n",
     b":2:1: error: GOTO 5, which is not there"),
    ("fanuc-sinker", "%\nM98 P5\nM30\n%\nO5 G0 X2.\nM99\n",
     b":2:5: error: a call of O5, which is not there"),
    ("linuxcnc", "%\no1 if [0]\nG0 X1\n%\no1 endif\n",
     b":2:1: error: o1 without its endif"),
    ("linuxcnc", "%\no1 call\n%\no1 sub\nG0 X1\no1 endsub\n",
     b":2:1: error: a call of o1, which is not there"),
    ("fanuc-sinker", "M98 <AB>\nM30\n<ABC>\nM99\n",
     b":1:5: error: a call of <AB>, which is not there"),
    ("fanuc-sinker", "M98 <AB> P1\nM30\n<AB>\nM99\n",
     b":1:1: error: M98 with P and a <NAME>"),
    ("fanuc-sinker", "M98 <A>\nM30\n<A>\nM99\n<a> (again)\nM99\n",
     b":5:1: error: a second <a>; the first is in line 3"),
    ("fanuc-sinker", "G65 <A> P1\nM30\n<A>\nM99\n",
     b":1:9: error: a second program behind G65"),
    ("linuxcnc", "G0 X#<_feed>\n",
     b":1:5: error: #<_feed>, which has no value; a parameter that the"),
    ("linuxcnc", "#<_x> = 3\n", b":1:1: error: a value for #<_x>, which is"),
    ("generic", "F5 G2 X1 I1 P2\n", b":1:13: error: P2: turns of an arc"),
    ("fanuc-wire", "M98 P1 L2\nM30\nO1\nM99\n",
     b":1:8: error: L2: in this dialect the centre of the top's arc"),
    ("fanuc-sinker", "O12345\nGOTO 7\nM30\nO23456\nN7 G0 X1.\nM30\n",
     b":2:1: error: GOTO 7, which is not there"),
    ("fanuc-sinker", "GOTO #5\n", b":1:1: error: GOTO a variable without"),
    ("generic", "M98 P2\nM2\nO2\nM99 P5\n", b":4:5: error: M99 with P; M99"),
    ("linuxcnc", "G0 X#<none>\n", b":1:5: error: #<none>, which has no value; a"),
    ("linuxcnc", "o1 while [1]\no1 endwhile\n", b":2:1: error: a loop that has"),
    ("linuxcnc", "o1 call\nG0 X1\n", b":1:1: error: a call of o1, which"),
    ("linuxcnc", "o1 if [0]\nG0 X1\n", b":1:1: error: o1 without its endif"),
    ("linuxcnc", "o1 endsub\n", b":1:1: error: o1 return or endsub outside"),
    ("linuxcnc", "o1 sub\no1 call\no1 endsub\no1 call\nG0 X1\n",
     b":2:1: error: a call inside 8 others"),
    ("linuxcnc", "G0 X[" + "[" * 40 + "1\n", b"brackets inside each other"[:8]),
    ("generic", "G0 X[1]\n", b":1:4: error: X[1] is not a word"),
]


# Fanuc's argument specification I, letter by letter, and II.
FIRST = dict(A=1, B=2, C=3, D=7, E=8, F=9, H=11, I=4, J=5, K=6, M=13, Q=17,
             R=18, S=19, T=20, U=21, V=22, W=23, X=24, Y=25, Z=26)
SECOND = [("A", 1), ("B", 2), ("C", 3)] + [("IJK"[n % 3], 4 + n)
                                          for n in range(30)]


def emitted(text):
    return [row.split()[-1] for row in done(
        "--machine", ROOT / "examples/machine.ini", "--dialect",
        "fanuc-sinker", "--emit", "iso", text=text).stdout.decode()
        .splitlines() if " X" in row]


@pytest.mark.parametrize("words", [list(FIRST.items()), SECOND])
def test_each_argument_fills_its_variable(words):
    call = " ".join(f"{letter}{10 + n}." for letter, n in words)
    text = f"G90 G21\nG0 X1.\nG65 P9010 {call}\nM30\nO9010\n" + \
        "".join(f"X[#{n} + {n}]\n" for _, n in words) + "M99\n"
    assert emitted(text) == ["X1"] + [f"X{10 + 2 * n}" for _, n in words]


def test_of_two_values_for_one_variable_the_later_one_counts():
    """The example of Fanuc's manual for mixed specifications."""
    assert emitted("G90 G21\nG65 P1 A1. B2. I-3. I4. D5.\nM30\nO1\n"
                   "G0 X#1\nX#2\nX#4\nX#7\nM99\n") == \
        ["X1", "X2", "X-3", "X5"]


def test_round_in_a_word_keeps_its_decimals_and_elsewhere_none():
    """The example of Fanuc's manual: the way back is what was gone before."""
    assert emitted("G91 G21\n#1=1.2345\n#2=2.3456\nG0 X-#1\nX-#2\n"
                   "X[ROUND[#1]+ROUND[#2]]\nG20\nX[ROUND[.12345]]\n"
                   "G21 G90 X[ROUND[#1]] Y[#[ROUND[1.4]]]\n#3=ROUND[#2]\n"
                   "X#3\nM30\n") == \
        ["X-1.2345", "X-3.5801", "X0.0009", "X3.1378", "Y1.2345", "X2"]


def test_a_comment_ends_no_statement_and_a_main_program_has_any_number():
    assert emitted("O12345678 (A)\nG90 G21\nG65 P1 (b) A1. (c) B2. ; (d)\n"
                   "IF [1 EQ 1] GOTO 9 (e)\nX99.\nN9 M30\nO1\nG0 X#1\nX#2\n"
                   "M99\n") == ["X1", "X2"]


def test_a_common_variable_that_nobody_set_is_told():
    def told(text):
        r = run("--dialect", "fanuc-sinker", "--check", text=text)
        assert r.returncode == 0, r.stderr
        return re.findall(rb":(\d+): note: (#\d+) has no value", r.stderr)
    assert told("G0 X1.\nX#500 Y2.\nX#501\nM30\n") == [(b"2", b"#500")]
    assert told("#500=1\nG0 X#500 Y#1\nM30\n") == []


def test_a_macro_is_gone_through_again_with_what_it_has_left():
    assert emitted("G90 G21\nG65 P1 L3 A5.\nG65 P1 A1.\nM30\nO1\n"
                   "G0 X#1\n#1 = #1 + 1\nM99\n") == ["X5", "X6", "X7", "X1"]


def test_m99_p_goes_on_at_a_line_of_who_called():
    """From two calls inside each other, over lines of the caller, and back to
    one that ends; N90 of the callee itself is another one."""
    assert emitted("""%
O0001 (MAIN)
G90 G21
#1=0
N10 #1=#1+1
G65 P2 A#1
G0 X99.
N90 G0 X50.
IF [#1 LT 3] GOTO 10
M99 P95
X98.
N95 X0
M30
O2
N90 G0 X#1
M98 P3
X97.
N20 X10.
M99 P90
O3
X20.
M99 P20
%
""") == ["X1", "X20", "X10", "X50", "X2", "X20", "X10", "X50",
         "X3", "X20", "X10", "X50", "X0"]


def test_a_goto_stays_in_its_program_wherever_the_label_stands():
    """The first line of a program may have its O word, and the line behind a
    GOTO the O word of the next one."""
    assert emitted("%\n\nO0001\n(A)\nN1 G90 G21 G0 X[5+#1]\n#1=#1+1\n"
                   "IF [#1 LT 2] GOTO 1\nM30\n") == ["X5", "X6"]
    r = run("--dialect", "fanuc-sinker", "--check",
            text="G0 X1.\nGOTO 5\nN5 O2\nX2.\nM99\n")
    assert r.returncode == 65 and b"GOTO 5, which is not there" in r.stderr


def test_what_is_printed_is_ignored_with_one_note():
    r = run("--dialect", "fanuc-sinker", "--check",
            text="POPEN\nG0 X1.\nN5 DPRNT[X#100[44]*(A]\nPCLOS (end)\nM30\n")
    assert r.returncode == 0, r.stderr
    assert r.stderr.count(b"note: ") == 1
    assert b":1: note: POPEN is ignored: nothing is printed" in r.stderr
    assert emitted("DPRNT[X]\nG0 G90 G21 X1.\nM30\n") == ["X1"]


@pytest.mark.parametrize("dialect, text, said", REFUSED)
def test_what_cannot_be_carried_out_is_refused_at_its_place(dialect, text,
                                                            said):
    r = run("--dialect", dialect, "--check", text=text)
    assert r.returncode == 65 and said in r.stderr, r.stderr


def test_places_and_offsets_of_the_machine_are_known(tmp_path):
    path = tmp_path / "p.nc"
    path.write_text("G10 L2 P1 X5.\nG54 G0 X3. Y1.5\nG0 Y[#5041*10+#5221]\n"
                    "G0 X[#5021]\n")
    # X 3 from 5 is 8 of the machine; Y is 3 times 10 and 5.
    assert ours(path, "fanuc-sinker")[1:] == [(8, 35, 0, 0, 0, 0),
                                              (13, 35, 0, 0, 0, 0)]
