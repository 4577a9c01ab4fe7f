"""Mutation operators: all places of a source where a small mistake can be made, by function.

A place is told by (function, operator, number), which no reformatting and no renaming of variables
changes.  C is looked at token by token, as its macros allow no other way: functions by their
braces, terms and statements by what ends them.  Not every place of C makes a program that compiles;
who asks finds out.  Python is changed in its syntax tree.
"""

import ast
import re
from dataclasses import dataclass

OPERATORS = {
    "sign": "+ for -, or - for +",
    "compare": "< for <=, == for != and the like",
    "logic": "&& for ||, or || for &&",
    "direction": "a rounding, bound or extreme of the other side: APM_UP for APM_DOWN, max for min",
    "term": "a term of a sum is left out",
    "factor": "a factor of a product is left out (Python)",
    "constant": "twice a number, or 1 for 0",
    "index": "an index is one more",
    "drop": "a statement is left out",
}


@dataclass(frozen=True)
class Mutant:
    function: str
    operator: str
    number: int         # among the places of this operator in this function, from 1
    line: int
    change: str         # for people
    text: str           # the whole source with it

    @property
    def key(self):
        return "%s %s %d" % (self.function, self.operator, self.number)


def numbered(places):
    """Mutants of (function, operator, line, change, text) in the order of the source."""
    counts = {}
    for function, operator, *rest in places:
        counts[function, operator] = counts.get((function, operator), 0) + 1
        yield Mutant(function, operator, counts[function, operator], *rest)


def mutants(name, text):
    """All mutants of a source of this name."""
    of_c = name.endswith((".c", ".h", ".inc"))
    return list(numbered(c_places(text) if of_c else python_places(text)))


# ---- C

TOKEN = re.compile(r"""(?P<skip>/\*.*?\*/|//[^\n]*|\s+|^[ \t]*\#(?:\\\n|[^\n])*)
    |(?P<text>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')
    |(?P<number>(?:0[xX][0-9a-fA-F.]+(?:[pP][+-]?\d+)?|\.?\d[\d.]*(?:[eE][+-]?\d+)?)[uUlLfF]*)
    |(?P<name>[A-Za-z_]\w*)
    |(?P<sign>->|\+\+|--|<<=|>>=|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|[^\w\s])""",
                   re.VERBOSE | re.DOTALL | re.MULTILINE)
OPEN, CLOSE = "([{", ")]}"
SIGNS = {"+": "-", "-": "+", "+=": "-=", "-=": "+="}
COMPARISONS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}
LOGIC = {"&&": "||", "||": "&&"}
DIRECTIONS = [("APM_UP", "APM_DOWN"), ("mpz_fdiv_q", "mpz_cdiv_q"), ("fmin", "fmax"), ("lb", "ub"),
              ("num_min", "num_max"), ("low", "high"), ("mpz_fdiv_q_2exp", "mpz_cdiv_q_2exp"),
              ("mpz_fdiv_q_ui", "mpz_cdiv_q_ui")]
OTHER = {**dict(DIRECTIONS), **{b: a for a, b in DIRECTIONS}}
ENDS_TERM = {";", ",", "?", ":", "+", "-", "<", ">", "<=", ">=", "==", "!=", "&&", "||", "=", "|"}
KEYWORDS = {"return", "case", "goto", "break", "continue", "if", "else", "for", "while", "do",
            "switch",
            "default", "sizeof", "const", "static", "enum", "typedef", "struct", "int", "long",
            "double",
            "size_t", "unsigned", "char", "void", "volatile"}


@dataclass(frozen=True)
class Token:
    kind: str
    text: str
    start: int
    end: int


def tokens_of(text):
    found, at = [], 0
    while at < len(text):
        match = TOKEN.match(text, at)
        if match.lastgroup != "skip":
            found.append(Token(match.lastgroup, match.group(), at, match.end()))
        at = match.end()
    return found


def partners(tokens):
    """Of each bracket the place of the other one."""
    found, stack = {}, []
    for i, token in enumerate(tokens):
        if token.kind == "sign" and token.text in OPEN:
            stack.append(i)
        elif token.kind == "sign" and token.text in CLOSE:
            start = stack.pop()
            found[start], found[i] = i, start
    return found


def functions(tokens):
    """(name, first, last token of the body) of each function, brackets of the body included."""
    other, i = partners(tokens), 0
    while i < len(tokens):
        if tokens[i].text != "{":
            i += 1
            continue
        if i and tokens[i - 1].text == ")":
            before = other[i - 1] - 1
            if tokens[before].text == ")":              # R(name)(...)
                before -= 1
            if tokens[before].kind == "name":
                yield tokens[before].text, i, other[i]
        i = other[i] + 1


def c_places(text):
    tokens = tokens_of(text)
    other = partners(tokens)
    for name, first, last in functions(tokens):
        for i in range(first + 1, last):
            for operator, start, end, new in changes(tokens, other, i):
                old = text[start:end]
                change = "%s -> %s" % (" ".join(old.split()), new.strip() or "nothing")
                yield (name, operator, text.count("\n", 0, start) + 1, change,
                       text[:start] + new + text[end:])


def changes(tokens, other, i):
    """(operator, start, end, what to put there) of each place that begins at a token."""
    token, before, after = tokens[i], tokens[i - 1], tokens[i + 1]
    here = token.start, token.end
    operand = before.kind in ("name",
                              "number") and before.text not in KEYWORDS or before.text in (")", "]")
    if token.text in SIGNS and (operand or len(token.text) == 2):
        yield ("sign", *here, SIGNS[token.text])
        if len(token.text) == 1:
            j = i + 1
            while tokens[j].text not in ENDS_TERM or j == i + 1:
                if tokens[j].text in CLOSE:
                    break
                j = other[j] + 1 if tokens[j].text in OPEN else j + 1
            yield "term", token.start, tokens[j - 1].end, ""
    elif token.text in COMPARISONS:
        yield ("compare", *here, COMPARISONS[token.text])
    elif token.text in LOGIC:
        yield ("logic", *here, LOGIC[token.text])
    elif token.text in OTHER:
        yield ("direction", *here, OTHER[token.text])
    elif token.kind == "number":
        zero = not re.search("[1-9a-fA-F]", re.sub("^0[xX]|[eEpP].*$", "", token.text))
        yield ("constant", *here,
               "1" + ".0" * ("." in token.text) if zero else "(2 * %s)" % token.text)
    if token.text == "[" and after.text != "]":
        yield "index", tokens[other[i]].start, tokens[other[i]].start, " + 1"
    if before.text in (";", "{", "}", ")", "else") and token.kind == "name" \
            and token.text not in KEYWORDS and begins_statement(tokens, other, i):
        j = i
        while tokens[j].text not in (";", *CLOSE):
            j = other[j] + 1 if tokens[j].text in OPEN else j + 1
        if tokens[j].text == ";" and any(t.text in ("=", "(", "+=", "-=", "*=", "|=", "&=", "++",
                                                    "--") for t in tokens[i + 1:j]):
            yield "drop", token.start, tokens[j].end, ";"


def begins_statement(tokens, other, i):
    """Not the rest of a cast, a declaration (two names in a row, or a star after the first) or what
    an initializer holds."""
    if tokens[i - 1].text == ")":
        opener = other[i - 1] - 1
        if tokens[opener].text not in ("if", "for", "while", "switch"):
            return False
    following = tokens[i + 1]
    if following.kind == "name" or following.text == "*":
        return False
    depth = i
    while depth > 0 and tokens[depth].text != "{":
        depth = other[depth] - 1 if tokens[depth].text in CLOSE else depth - 1
        if tokens[depth].text in ("(", "["):
            return False
    return tokens[depth - 1].text not in ("=", ",", "{")


# ---- Python

PYTHON_SIGNS = {ast.Add: ast.Sub, ast.Sub: ast.Add}
PYTHON_COMPARISONS = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt,
                      ast.Eq: ast.NotEq, ast.NotEq: ast.Eq}
PYTHON_EXTREMES = {"min": "max", "max": "min", "lower": "upper", "upper": "lower", "any": "all",
                   "all": "any"}


def python_places(text):
    """A mutant's text is the source with what ast makes of the changed node in its place."""
    data, starts = text.encode(), [0]
    for line in data.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    for function in ast.walk(ast.parse(text)):
        if isinstance(function, ast.FunctionDef):
            for node in ast.walk(function):
                for operator, change, undo in python_changes(node):
                    new = ast.unparse(node)
                    yield (function.name, operator, node.lineno, change, b"".join([
                        data[:starts[node.lineno - 1] + node.col_offset],
                        (new if isinstance(node, ast.stmt) else "(%s)" % new).encode(),
                        data[starts[node.end_lineno - 1] + node.end_col_offset:]]).decode())
                    undo()


def python_changes(node):
    """Makes one change after another: (operator, the change in words, what takes it back)."""
    def put(target, name, new):
        old = getattr(target, name)
        setattr(target, name, new)
        return lambda: setattr(target, name, old)

    if isinstance(node, (ast.BinOp, ast.AugAssign)) and type(node.op) in PYTHON_SIGNS:
        before = ast.unparse(node)
        undo = put(node, "op", PYTHON_SIGNS[type(node.op)]())
        yield "sign", "%s -> %s" % (before, ast.unparse(node)), undo
        if isinstance(node, ast.BinOp):
            undo = put(node, "right", ast.Constant(0))
            yield "term", "%s -> %s" % (before, ast.unparse(node)), undo
    elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
        before = ast.unparse(node)
        for side in ("left", "right"):
            undo = put(node, side, ast.Constant(1))
            yield "factor", "%s -> %s" % (before, ast.unparse(node)), undo
    elif isinstance(node, ast.Compare) and type(node.ops[0]) in PYTHON_COMPARISONS:
        before = ast.unparse(node)
        undo = put(node, "ops", [PYTHON_COMPARISONS[type(node.ops[0])](), *node.ops[1:]])
        yield "compare", "%s -> %s" % (before, ast.unparse(node)), undo
    elif isinstance(node, ast.BoolOp):
        before = ast.unparse(node)
        undo = put(node, "op", ast.Or() if isinstance(node.op, ast.And) else ast.And())
        yield "logic", "%s -> %s" % (before, ast.unparse(node)), undo
    elif isinstance(node, ast.Name) and node.id in PYTHON_EXTREMES:
        new = PYTHON_EXTREMES[node.id]
        yield "direction", "%s -> %s" % (node.id, new), put(node, "id", new)
    elif isinstance(node, ast.Attribute) and node.attr in PYTHON_EXTREMES:
        new = PYTHON_EXTREMES[node.attr]
        yield "direction", "%s -> %s" % (node.attr, new), put(node, "attr", new)
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
        new = 2 * node.value or 1
        yield "constant", "%s -> %s" % (node.value, new), put(node, "value", new)
