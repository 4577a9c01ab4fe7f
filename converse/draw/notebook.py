"""Values as notebooks show them: words or a table, and with matplotlib a picture."""

import base64
import html as markup

from ..storage import files

TYPES = {"svg": "image/svg+xml", "png": "image/png"}
CELL = 'style="text-align: left"'


def html(words, picture, kind, alt):
    """A value in HTML: words as they are, or those of table() and paragraph(), then its picture.

    picture -- a function that returns the bytes of an image of that kind, "svg" or "png"; it is
        left out where the function raises ConverseError, as all do without matplotlib
    alt -- what the image shows

    The picture is an image and not part of the page, whose style it would change."""
    if not isinstance(words, _Markup):
        words = "<pre>%s</pre>" % markup.escape(words)
    try:
        data = picture()
    except files.ConverseError:
        return str(words)
    return '%s<img alt="%s" src="data:%s;base64,%s">' % (
        words, markup.escape(alt), TYPES[kind], base64.b64encode(data).decode("ascii"))


class _Markup(str):
    """Text that is HTML already."""


def table(title, head, rows):
    """A table for html(): a title, a row of headings (or None), and rows of texts."""
    lines = [(head, "th")] * (head is not None) + [(row, "td") for row in rows]
    return _Markup("<p>%s</p><table>%s</table>" % (markup.escape(title), "".join(
        "<tr>%s</tr>" % "".join("<%s %s>%s</%s>" % (tag, CELL, markup.escape(text), tag)
                                for text in row) for row, tag in lines)))
