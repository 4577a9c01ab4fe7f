"""Groups that vectors of integers generate, and determinants."""

from typing import Any, List, Optional, Sequence, Tuple

Row = Tuple


def echelon(rows: Sequence[Sequence], columns: int) -> Tuple[List[Optional[Row]], List[Row]]:
    """Rows that generate the same group as the given rows, by Euclid's algorithm.

    Parameters
    ----------
    rows
        Rows of integers or Fractions.
    columns
        The number of columns that are brought to echelon form; further ones are carried along.

    Returns
    -------
    list
        For each column its pivot row, which is 0 in the columns before, or None.
    list
        The rows that are 0 in all of these columns.
    """
    rest = [tuple(row) for row in rows]
    pivots: List[Optional[Row]] = []
    for i in range(columns):
        here = [row for row in rest if row[i]]
        rest = [row for row in rest if not row[i]]
        while len(here) > 1:
            least = min(here, key=lambda row: abs(row[i]))
            here.remove(least)
            reduced = [tuple(x - row[i] // least[i] * y for x, y in zip(row, least))
                       for row in here]
            rest += [row for row in reduced if not row[i]]
            here = [least, *(row for row in reduced if row[i])]
        pivots.append(here[0] if here else None)
    return pivots, rest


def basis_along(q: Sequence[int]) -> List[Row]:
    """Vectors that generate all vectors of integers, for a q without a common factor: q.c is 1 for
    the last of them, and 0 for the others."""
    n = len(q)
    (last,), rest = echelon([(q[i], *(int(i == j) for j in range(n)))
                             for i in reversed(range(n))], 1)
    assert last is not None
    others = [row[1:] for row in rest]
    return [c if c > (0,) * n else tuple(-x for x in c) for c in others] + [
        tuple(last[0] * x for x in last[1:])]


def determinant(matrix: Sequence[Sequence]) -> Any:
    """The determinant of a square matrix, by its first row."""
    return sum((-1) ** j * x * determinant([[*row[:j], *row[j + 1:]] for row in matrix[1:]])
               for j, x in enumerate(matrix[0]) if x) if matrix else 1
