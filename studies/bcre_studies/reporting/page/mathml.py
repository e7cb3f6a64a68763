r"""Formulas as MathML, from the plain text in which the docstrings write them.

``"gamma (Sd - Sc) = v^2/(4 D)"`` becomes an element that browsers set and screen readers read.
Names of Greek letters become letters; ``_`` and ``^`` set what follows low and high, a letter after
a capital is an index (Sc, Sd, S0), ``sqrt(...)`` is a root, braces group without showing, and a
word of three letters or more is a word.
"""

from __future__ import annotations

import re
from html import escape

GREEK = {
    "gamma": "γ",
    "kappa": "κ",
    "sigma": "σ",
    "theta": "θ",
    "lambda": "λ",
    "Gamma": "Γ",
    "pi": "π",
}
UPRIGHT = {
    "Pe",
    "min",
    "max",
    "ln",
    "exp",
    "sin",
    "cos",
    "cot",
    "tan",
    "eff",
    "true",
    "exact",
    "full",
}
SIGNS = {"-": "−", "<=": "≤", ">=": "≥", "->": "→", "*": "·", "~": "∼", "+-": "±"}

_TOKEN = re.compile(r"\s*(\d+(?:\.\d+)?|[^\W\d_]+\d*|<=|>=|->|\+-|\S)")


def formula(text: str) -> str:
    """The formula as a ``<math>`` element; the text itself is its alternative."""
    tokens = _TOKEN.findall(text)
    body = _row(tokens, closing=None)
    if tokens:
        raise ValueError(f"{text!r}: {tokens[0]!r} closes what was never opened")
    return f'<math alttext="{escape(text)}">{body}</math>'


def _row(tokens: list[str], closing: str | None) -> str:
    items: list[str] = []
    while tokens and tokens[0] not in (")", "}"):
        items.append(_scripted(tokens))
    if closing is not None and (not tokens or tokens.pop(0) != closing):
        raise ValueError(f"a {closing!r} is missing")
    return f"<mrow>{''.join(items)}</mrow>"


def _scripted(tokens: list[str]) -> str:
    base = _atom(tokens)
    low = high = None
    while tokens and tokens[0] in ("_", "^"):
        if tokens.pop(0) == "_":
            low = _atom(tokens)
        else:
            high = _atom(tokens)
    if low and high:
        return f"<msubsup>{base}{low}{high}</msubsup>"
    if low:
        return f"<msub>{base}{low}</msub>"
    return f"<msup>{base}{high}</msup>" if high else base


def _atom(tokens: list[str]) -> str:
    token = tokens.pop(0)
    if token == "sqrt":
        tokens.pop(0)
        return f"<msqrt>{_row(tokens, ')')}</msqrt>"
    if token == "(":
        return f"<mrow><mo>(</mo>{_row(tokens, ')')}<mo>)</mo></mrow>"
    if token == "{":
        return _row(tokens, "}")
    if token[0].isdigit():
        return f"<mn>{token}</mn>"
    if token[0].isalpha() or token == "∂":
        return _word(token, tokens) if _is_word(token) else _name(token)
    if token == "|":
        return '<mo stretchy="false" lspace="0" rspace="0">|</mo>'
    return f"<mo>{escape(SIGNS.get(token, token))}</mo>"


def _is_word(token: str) -> bool:
    known = token in GREEK or token in UPRIGHT
    return token == "of" or (len(token) > 2 and token.isalpha() and not known)


def _word(token: str, rest: list[str]) -> str:
    """With a space on either side, but none before what encloses or ends it, or another word."""
    space = "\N{NO-BREAK SPACE}"
    closed = not rest or rest[0] in (":", "(", ")", ",") or _is_word(rest[0])
    after = "" if closed else space
    return f"<mtext>{space}{token}{after}</mtext>"


def _name(token: str) -> str:
    if token in GREEK:
        return f"<mi>{GREEK[token]}</mi>"
    if token in UPRIGHT:
        return f'<mi mathvariant="normal">{token}</mi>'
    if re.fullmatch("d[a-z]", token):  # a step or a difference: two letters, not one name
        return f'<mspace width="0.17em"/><mi>d</mi><mi>{token[1]}</mi>'
    index = re.fullmatch(r"([A-Z])([a-z])|([A-Za-z])(\d)", token)
    if index:
        letter, low = filter(None, index.groups())
        kind = "mn" if low.isdigit() else "mi"
        return f"<msub><mi>{letter}</mi><{kind}>{low}</{kind}></msub>"
    return f"<mi>{token}</mi>"
