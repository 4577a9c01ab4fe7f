"""Runs the core's C text, function by function, with numbers of any kind.

A function is read as it stands in its file, and executed statement by statement in the order in
which C would: what `+`, `-`, `*` do is up to the numbers, which may be doubles, polynomials, bounds
of roundings or the text of another language.  So what is proved with them is proved of these very
lines.  It knows what those functions use, and stops with one line where it meets anything else.
"""

import operator
import re

from pycparser import c_ast, c_parser

TYPES = """typedef double vec; typedef unsigned long mask, uint64_t;
typedef int batch, point, sums, loewner, potential;
"""
BINARY = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv,
          "<<": operator.lshift,
          "&": operator.and_, "|": operator.or_, "^": operator.xor,
          "==": operator.eq, "!=": operator.ne,
          "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}


class CTextError(Exception):
    """The text is not what is understood here."""


def _stripped(text):
    """Without comments, and with the loop that csrc/loewner has a macro for."""
    text = re.sub(r"/\*.*?\*/", " ", text, flags=re.DOTALL)
    return re.sub(r"\bFOR_WAVES\((\w+), (\w+)\)",
                  r"for (int \2 = FIRST; \2 < waves_of(\1); \2++)", text)


def defined(text, name):
    """What #define makes of a name that stands for a number."""
    found = re.findall(r"^#define %s (\S+)" % name, text, re.MULTILINE)
    if len(found) != 1:
        raise CTextError("%s is defined %d times" % (name, len(found)))
    return number(found[0])


def constant(text, name):
    """A double that is defined among others by static const double."""
    found = re.findall(r"^static const double (.*?);", _stripped(text), re.MULTILINE | re.DOTALL)
    values = [part.split("=", 1) for line in found for part in line.split(",") if "=" in part]
    for key, value in values:
        if key.strip() == name:
            program = parsed("double value = %s;" % value, name)
            return execute(program.ext[0].init, {})
    raise CTextError("no constant %s" % name)


def number(word):
    """A C constant: an int, or the double that it is rounded to."""
    if re.fullmatch(r"\d+", word):
        return int(word)
    return float.fromhex(word) if word[:2] in ("0x", "0X") else float(word)


def parsed(text, what):
    try:
        return c_parser.CParser().parse(text, what)
    except Exception as error:
        raise CTextError("%s cannot be read: %s" % (what, error)) from None


def function(text, name):
    """The function of that name: its parameters, and its statements."""
    text = _stripped(text)
    found = [*re.finditer(r"^(?:INLINE|static|int|double|void) [^;{}#=]*\b%s\([^;{}]*\)\s*\{"
                          % name, text, re.MULTILINE)]
    if len(found) != 1:
        raise CTextError("function %s stands %d times" % (name, len(found)))
    end = found[0].end()
    while text.count("{", found[0].start(), end) > text.count("}", found[0].start(), end):
        end = text.index("}", end) + 1
    code = re.sub(r"^INLINE", "static", text[found[0].start():end])
    node = parsed(TYPES + code, name).ext[-1]
    names = [p.name for p in node.decl.type.args.params]
    return Function(name, names, node.body.block_items or [])


class Return(Exception):
    pass


class Place:
    """What a pointer points to: an entry of a list, a member, or a variable."""

    def __init__(self, get, put):
        self.get, self.put = get, put


class Function:
    def __init__(self, name, parameters, statements):
        self.name, self.parameters, self.statements = name, parameters, statements

    def initial(self, variable):
        """The expression that a variable is declared with, wherever that is."""
        found = []

        class Declarations(c_ast.NodeVisitor):
            def visit_Decl(self, node):
                found.extend([node.init] if node.name == variable else [])
                self.generic_visit(node)

        for node in self.statements:
            Declarations().visit(node)
        if len(found) != 1 or found[0] is None:
            raise CTextError("%s declares %s %d times" % (self.name, variable, len(found)))
        return found[0]

    def bound(self, names, noted=None):
        """As a Python function, which sees these names, too."""
        def call(*values):
            scope = dict(names)
            scope.update(zip(self.parameters, values))
            try:
                run(self.statements, scope, noted)
            except Return as result:
                return result.args[0]
            return None
        return call


def run(statements, names, noted=None):
    """Executes statements.  noted(name, value): what is to be known as a variable that is declared
    with this value."""
    for node in statements:
        _statement(node, names, noted)


def _statement(node, names, noted):
    if isinstance(node, c_ast.Compound):
        run(node.block_items or [], names, noted)
    elif isinstance(node, c_ast.DeclList):
        run(node.decls, names, noted)
    elif isinstance(node, c_ast.Decl):
        if node.init is None:
            value = _room(node.type, names)
        else:
            value = execute(node.init, names)
        names[node.name] = value if noted is None else noted(node.name, value)
    elif isinstance(node, c_ast.Assignment):
        place, value = _place(node.lvalue, names), execute(node.rvalue, names)
        if node.op != "=":
            if node.op[:-1] not in BINARY:
                raise CTextError("%s: %s is not known here" % (node.coord, node.op))
            value = BINARY[node.op[:-1]](place.get(), value)
        place.put(value)
    elif isinstance(node, c_ast.For):
        if node.init is not None:
            _statement(node.init, names, None)
        while execute(node.cond, names):
            try:
                _statement(node.stmt, names, noted)
            except Continue:
                pass
            _statement(node.next, names, None)
    elif isinstance(node, c_ast.If):
        branch = node.iftrue if execute(node.cond, names) else node.iffalse
        if branch is not None:
            _statement(branch, names, noted)
    elif isinstance(node, c_ast.Continue):
        raise Continue
    elif isinstance(node, c_ast.Return):
        raise Return(execute(node.expr, names))
    elif isinstance(node, c_ast.ExprList):
        run(node.exprs, names, noted)
    else:
        execute(node, names)


class Continue(Exception):
    pass


def _room(kind, names):
    if isinstance(kind, c_ast.ArrayDecl):
        return [_room(kind.type, names) for _ in range(execute(kind.dim, names))]
    return None


def _place(node, names):
    """Where a value is to be put."""
    if isinstance(node, c_ast.ID):
        return Place(lambda: names[node.name], lambda value: names.update({node.name: value}))
    if isinstance(node, c_ast.ArrayRef):
        row, k = execute(node.name, names), execute(node.subscript, names)
        return Place(lambda: row[k], lambda value: row.__setitem__(k, value))
    if isinstance(node, c_ast.StructRef):
        owner, name = execute(node.name, names), node.field.name
        return Place(lambda: getattr(owner, name), lambda value: setattr(owner, name, value))
    if isinstance(node, c_ast.UnaryOp) and node.op == "*":
        return execute(node.expr, names)
    raise CTextError("%s: nothing can be put there" % node.coord)


def execute(node, names):
    """The value of an expression."""
    if isinstance(node, c_ast.Constant):
        return number(node.value)
    if isinstance(node, c_ast.ID):
        if node.name not in names:
            raise CTextError("%s: %s is not known here" % (node.coord, node.name))
        return names[node.name]
    if isinstance(node, (c_ast.ArrayRef, c_ast.StructRef)):
        return _place(node, names).get()
    if isinstance(node, c_ast.Assignment):
        _statement(node, names, None)
        return _place(node.lvalue, names).get()
    if isinstance(node, c_ast.InitList):
        return [execute(part, names) for part in node.exprs]
    if isinstance(node, c_ast.Cast):
        return execute(node.expr, names)
    if isinstance(node, c_ast.TernaryOp):
        return execute(node.iftrue if execute(node.cond, names) else node.iffalse, names)
    if isinstance(node, c_ast.FuncCall):
        given = [] if node.args is None else node.args.exprs
        return execute(node.name, names)(*(execute(part, names) for part in given))
    if isinstance(node, c_ast.BinaryOp):
        return _binary(node, names)
    if isinstance(node, c_ast.UnaryOp):
        return _unary(node, names)
    raise CTextError("%s: %s is not known here" % (node.coord, type(node).__name__))


def _binary(node, names):
    x = execute(node.left, names)
    if node.op in ("&&", "||"):
        return x if bool(x) == (node.op == "||") else execute(node.right, names)
    y = execute(node.right, names)
    if node.op == "/" and isinstance(x, int) and isinstance(y, int) and x >= 0 < y:
        return x // y
    if node.op not in BINARY:
        raise CTextError("%s: %s is not known here" % (node.coord, node.op))
    try:
        return BINARY[node.op](x, y)
    except TypeError:
        raise CTextError("%s: %s of these is not known here" % (node.coord, node.op)) from None


def _unary(node, names):
    if node.op == "sizeof":
        return None                             # what uses it, memset, knows
    if node.op == "&":
        return _place(node.expr, names)
    if node.op in ("p++", "++"):
        place = _place(node.expr, names)
        value = place.get()
        place.put(value + 1)
        return value if node.op == "p++" else value + 1
    value = execute(node.expr, names)
    if node.op == "*":
        return value.get() if isinstance(value, Place) else value[0]
    known = {"-": operator.neg, "+": operator.pos, "~": operator.invert, "!": operator.not_}
    if node.op not in known:
        raise CTextError("%s: %s is not known here" % (node.coord, node.op))
    return known[node.op](value)
