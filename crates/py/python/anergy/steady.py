"""The steady state of a network as tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from anergy import _display, _export, _maps
from anergy._core import Model, _unknown_name

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

__all__ = ["Steady", "Table"]


class Table(dict[str, npt.NDArray[Any]]):
    """A table: a dict of column names to numpy arrays, one value per row.

    The column `id` has the names of the rows; other columns are in SI, as their names say. Every
    column has shape `(n,)`.

    >>> import anergy
    >>> edges = anergy.examples.load("three-houses").solve().edges
    >>> list(edges)
    ['id', 'kind', 'm_flow_kg_s', 'dp_pa']
    >>> edges["id"][edges["kind"] == "pump"].tolist()
    ['sf1.feed_in_pump', 'sf2.feed_in_pump']
    """

    _key = "id"

    def __init__(self, columns: Mapping[str, npt.ArrayLike]) -> None:
        arrays = {name: np.asarray(column) for name, column in columns.items()}
        if len({array.shape for array in arrays.values()}) > 1:
            raise ValueError("the columns of a table must have the same length")
        super().__init__(arrays)

    @property
    def ids(self) -> list[str]:
        """Names of the rows."""
        return [str(name) for name in self[self._key]]

    def row(self, id: str) -> dict[str, Any]:
        """One row as dict of str and float.

        Raises UnknownNameError, a KeyError, for a row that does not exist.
        """
        found = np.flatnonzero(self[self._key] == id)
        if found.size == 0:
            raise _unknown_name("row", id, self.ids)
        return {name: column[found[0]].item() for name, column in self.items()}

    def to_pandas(self) -> pandas.DataFrame:
        """The table as pandas.DataFrame with `id` as index.

        Raises ImportError without pandas: `pip install anergy[pandas]`.
        """
        return _export.table_to_pandas(self)

    def __repr__(self) -> str:
        return _display.table_text(self)

    def _repr_html_(self) -> str:
        return _display.table_html(self)


@dataclass(frozen=True)
class Steady:
    """Pressures, flows and temperatures of a whole network, from `Model.solve`.

    >>> import anergy
    >>> steady = anergy.examples.load("three-houses").solve()
    >>> steady["sf4.cold"]["p_pa"]
    150000.0
    >>> steady["sf2.feed_in_pump"]["kind"]
    'pump'
    """

    nodes: Table
    """id, p_pa (above the atmosphere), t_k, elevation_m."""
    edges: Table
    """id, kind, m_flow_kg_s (from a to b), dp_pa (p_a - p_b)."""
    iterations: int
    """Newton iterations of the first hydraulic solve."""
    residual_pa: float
    """Largest pressure residual of an edge, Pa."""
    model: Model = field(repr=False, compare=False)
    """What was solved."""

    def __getitem__(self, id: str) -> dict[str, Any]:
        """The row of an edge or, if there is none of that name, of a node.

        Raises UnknownNameError, a KeyError, with the most similar name.
        """
        for table in (self.edges, self.nodes):
            if id in table.ids:
                return table.row(id)
        raise _unknown_name("edge or node", id, self.edges.ids + self.nodes.ids)

    def plot_map(self, quantity: str = "t_k", ax: Axes | None = None) -> Axes:
        """Draws the network, its lines coloured by a quantity, with arrows along the flow.

        Parameters
        ----------
        quantity : str
            A column of `nodes` or `edges`: `t_k`, `p_pa`, `m_flow_kg_s`, `dp_pa`.
        ax : matplotlib.axes.Axes, optional
            Where to draw; absent: a new figure.

        Raises
        ------
        ImportError
            Without matplotlib: `pip install anergy[plot]`.
        UnknownNameError
            For a quantity that no line has.
        """
        return _maps.of_steady(self, quantity, ax)

    def __repr__(self) -> str:
        return (
            f"<anergy.Steady: {len(self.nodes.ids)} nodes, {len(self.edges.ids)} edges, "
            f"{self.iterations} iterations, residual {self.residual_pa:.1e} Pa>"
        )

    def _repr_html_(self) -> str:
        return self.nodes._repr_html_() + self.edges._repr_html_()
