# SPDX-License-Identifier: BSD-3-Clause
"""The page of a question in a cell of a notebook: Python asks it, and gets its answers. Needs anywidget."""
from __future__ import annotations

import json
import re
from typing import Any

import anywidget
import numpy as np
import traitlets

from ._answers import Selection
from ._library import ArgumentError, Error, whole
from ._program import page_of

# An answer counts only if it is of the newest question, which a page that has just begun gets again.
_ESM = """
export default { render({ model, el }) {
  const frame = document.createElement("iframe");
  frame.title = "conus: which areas are in this cone?";
  frame.style = `width: 100%; height: ${model.get("height")}px; border: 0`;
  frame.sandbox = "allow-scripts allow-downloads"; // no way from the page into the notebook
  frame.srcdoc = model.get("_page");
  const ask = () => frame.contentWindow?.postMessage({ conus: model.get("_asked") }, "*");
  const receive = ({ source, data }) => {
    if (!data?.conus || source !== frame.contentWindow) return;
    if (data.conus.id !== model.get("_asked").id) return ask();
    model.set("answer", data.conus);
    model.save_changes();
  };
  addEventListener("message", receive);
  model.on("change:_asked", ask);
  el.append(frame);
  return () => { removeEventListener("message", receive); model.off("change:_asked", ask); };
} };
"""


def _parts(fragment: str) -> dict[str, str]:
    pairs = (part.split("=", 1) for part in fragment.split("&"))
    return {name: value for name, value in pairs if name not in ("v", "cut")}


class Widget(anywidget.AnyWidget):  # type: ignore[misc]
    """The page of ``hits.to_html()``, whose cone is moved by hand and by :meth:`ask`.

    >>> shown = conus.widget.Widget(atlas.select(origin=(-90, 20, 20), toward=(0, -10, 10)))  # doctest: +SKIP
    >>> shown.observe(lambda change: print(shown.rows[0]["name"]), "answer")  # doctest: +SKIP
    """

    _esm = _ESM
    _page = traitlets.Unicode().tag(sync=True)
    _asked = traitlets.Dict().tag(sync=True)
    answer = traitlets.Dict().tag(sync=True)  #: changes with each answer, and with what is refused
    height = traitlets.Int().tag(sync=True)

    def __init__(self, hits: Selection, *, height: int = 720) -> None:
        page = page_of(hits)
        given = json.loads(re.findall(r'id="question">(.*)</script>', page)[0])
        super().__init__(_page=page, _asked={"id": 0}, answer={"id": 0, "refused": "", **given},
                         height=whole("height", height))

    def ask(self, **changes: Any) -> None:
        """Asks with other origin, toward, angle, layers, resolution or range: ``ask(angle=8)``.

        The page answers when the cell has ended, and is shown.
        """
        is_open = self.answer["id"] != self._asked["id"]
        parts: dict[str, Any] = {**_parts(self._asked["ask"] if is_open else self.answer["fragment"]), **changes}
        texts = {name: value if isinstance(value, str) else ",".join(repr(float(x)) for x in np.atleast_1d(value))
                 for name, value in parts.items()}
        link = "&".join(f"{name}={text}" for name, text in texts.items())
        self._asked = {"id": self._asked["id"] + 1, "ask": link}

    def _said(self, what: str) -> str:
        if self.answer["id"] != self._asked["id"]:
            raise Error("the page has not answered yet: it does when the cell that asked has ended, and it is shown")
        if self.answer["refused"]:
            raise ArgumentError(self.answer["refused"])
        return str(self.answer[what])

    @property
    def question(self) -> dict[str, str]:
        """What the rows are of, to a micrometre: the option's name, and its value in words."""
        return _parts(self._said("fragment"))

    @property
    def rows(self) -> list[dict[str, Any]]:
        """The newest answer, as ``conus query --format ndjson`` has it."""
        return [json.loads(row) for row in self._said("rows").splitlines()]

    def to_dataframe(self) -> Any:
        """The rows as a pandas table."""
        import pandas

        return pandas.DataFrame(self.rows)
