"""The words in which reports and figures state a theorem: the map of a Problem, its potential and
its parameters, and how lines are broken."""

import textwrap
from fractions import Fraction

from . import potential
from .exact import is_decimal, number_text
from .map import LINE

WIDTH, INDENT = 98, 11                  # characters of a line, and of the labels at its left
LONGEST = 12                            # A value of epsilon with more digits is not printed.
TORUS = {1: "rotational invariant circle", 2: "invariant torus", 3: "invariant torus"}


# ---- lines

def labelled(label, text):
    """A line with a label, continued below where it is long, unless it is a line of the input."""
    first = label.ljust(INDENT)
    return [(first + text).rstrip()] if text.startswith(">") else _wrapped(text, first)


def _wrapped(text, first, indent=INDENT):
    return [line.replace("\xa0", " ") for line in textwrap.wrap(
        text, WIDTH, initial_indent=first, subsequent_indent=" " * indent,
        break_long_words=False, break_on_hyphens=False)]


def whole(text):
    """The text as a word that is not divided between two lines."""
    return text.replace(" ", "\xa0")


# ---- the map and its parameters

def map_lines(problem):
    """The map, with its potential and its force, in lines."""
    gradient = "V'(y)" if problem.map.dimension == 1 else "grad V(y)"
    return indented(["The map  y' = y + J',  J' = J - %s,  y modulo 2 pi," % gradient,
                     "with  V(y) = %s," % potential_text(problem), *_force(problem)])


def _force(problem):
    """The same map without V: J' = J + K sin y, or a line for each component."""
    lines = []
    for i, letter in enumerate(potential.angle_names("J", problem.map.dimension)):
        lines += ["%s' = %s%s," % (letter, letter, potential.harmonics_text(
            problem.waves, _forms(problem), [wave[i] for wave in problem.waves], 1,
            problem.map.dimension))]
    return ["that is,  " + lines[0], *lines[1:]]


def indented(lines):
    return [line for each in lines for line in _wrapped(each, "  ", 8)]


def ended(lines):
    """The lines with a full stop, unless they end with dots."""
    return [*lines[:-1], lines[-1].rstrip(",") + "." * (not lines[-1].endswith("..."))]


def potential_text(problem):
    """V in the problem's parameters, exactly."""
    return potential.potential_text(problem.waves, _forms(problem), problem.map.dimension)


def _forms(problem):
    """Each amplitude as a linear form of the parameters, {name: factor}; "" is the constant's."""
    if problem.by_ranges and not problem.parameters:
        return [{letter: Fraction(1)} for letter in "abc"]
    forms, names = [], problem.parameters or parameters(problem)
    for middle, *parts in zip(problem.amplitude, *problem.parts):
        form = {"": middle}
        for (name, low, high), part in zip(names, parts):
            if part:                    # t = (2 x - low - high)/(high - low)
                form[name] = 2 * part / (high - low)
                form[""] -= part * (low + high) / (high - low)
        forms.append(form)
    return forms


def parameters(problem):
    """(name, low, high) of each parameter of V; None: a, b and c move along one segment."""
    if problem.parameters:
        return [each for each in problem.parameters if each[1] < each[2]]
    if problem.together and any(problem.half[:3]):
        return None
    if problem.by_ranges:
        return [(letter, *ends) for letter, ends in zip("abc", problem.abc)]
    return [("t[%d]" % m, Fraction(-1), Fraction(1)) for m in range(1, 1 + len(problem.parts))]


def conditions(problem, at_once=False):
    """The lines that name the parameters for which the theorem holds.  With at_once they name
    larger multiples also (Proof.at_once)."""
    names = parameters(problem)
    if names is None:
        ends = [whole("(%s)" % ", ".join(map(number_text, corner))) for corner in zip(*problem.abc)]
        lines = ["for every (a, b, c) on the segment from %s to %s" % tuple(ends)]
    else:
        ranges = [whole("%s in [%s, %s]" % (name, *map(number_text, ends)))
                  for name, *ends in names if ends[0] < ends[1]]
        values = ["%s = %s" % (name, number_text(low)) for name, low, high in names if low == high]
        lines = ["for %s%s" % ("every " * bool(ranges), ", ".join(ranges + values))] \
            if names else []
    if at_once:
        lines += ["and for every " + _multiples(problem, names)]
    return lines + _epsilon(problem, at_once)


def _multiples(problem, names):
    """The multiples s >= 1 that are covered: of all amplitudes or, where there is one parameter,
    of those at its upper end."""
    if names is None:
        return "multiple s >= 1 of the upper end"
    forms = [{name for name, x in form.items() if x} for form in _forms(problem)]
    zero = {name for name, low, high in names if low == high == 0}
    for name, _, high in names:         # V is this parameter times a function: s V is at s times it
        if high > 0 and {name} in forms and all(form <= zero or form == {name} for form in forms):
            return "%s > %s" % (name, number_text(high))
    if problem.by_ranges and not problem.parameters:
        return "multiple s (a, b, c), s >= 1"
    if len(problem.parts) == len(names) == 1:
        return "multiple s >= 1 of the amplitudes at %s = %s" % (names[0][0],
                                                               number_text(names[0][2]))
    return "multiple s >= 1 of these amplitudes"


def _epsilon(problem, at_once):
    """The same in the thesis's epsilon, in a line, where epsilon parametrizes the patch."""
    if not problem.by_ranges or problem.parameters or not (
            problem.together or all(low == high for low, high in problem.abc)):
        return []
    a, b, c = problem.abc
    ends = [x / LINE for x in a]
    if b != a or c != tuple(2 * x for x in a) or ends[0] <= 0 or \
            not all(is_decimal(x) and len(number_text(x)) <= LONGEST for x in ends):
        return []
    low, high = map(number_text, ends)
    return ["that is, with a = b = c/2 = %s epsilon, for %s%s" % (
        number_text(LINE), "epsilon = " + low if low == high else
        "every epsilon in [%s, %s]" % (low, high),
        " and every epsilon > " + high if at_once else "")]


def one_angle(problem):
    """The only angle that the waves depend on; None: they depend on several or on none."""
    felt = {i for k, _ in problem.present for i, x in enumerate(k) if x}
    return min(felt) if len(felt) == 1 else None
