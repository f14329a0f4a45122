"""Where the kernels' nonzeros go: fixed sparse maps from knot derivatives to those of the whole NLP.

The knot variables are linear in the unknowns, so each nonzero of the NLP's Jacobian or Hessian is a fixed linear
combination of nonzeros at knots. The maps are built once a mesh.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from liftopt.types import Array

Index = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Pattern:
    """A sparse matrix whose nonzeros are ``scatter @ values + offset``, in the order of compressed columns.

    Attributes:
        shape: sparsity of the matrix; its data have no meaning.
        scatter: (nonzeros, values).
        offset: (nonzeros,) the constant part.
    """

    shape: sp.csc_matrix
    scatter: sp.csc_matrix
    offset: Array


def jacobian_pattern(
    blocks: Sequence[Any],
    selects: Sequence[sp.csc_matrix],
    weights: Array,
    combine: sp.csc_matrix,
    linear: sp.csc_matrix,
) -> Pattern:
    """Return the pattern of ``G diag(dc/dy) S + A``; values are the nonzeros of all dc/dy, part by part, knot by knot.

    Args:
        blocks: CasADi sparsity of dc/dy of each part.
        selects: S of each part.
        weights: (K,), for the number of knots.
        combine: G.
        linear: A.
    """
    rows, cols, sources, values = [], [], [], []
    first_output = first_value = 0
    by_output = sp.csc_matrix(combine)
    for block, select in zip(blocks, selects, strict=True):
        n_c, n_y, knots = block.size1(), block.size2(), len(weights)
        r, c = (np.asarray(part, dtype=np.int64) for part in block.get_triplet())
        knot = np.repeat(np.arange(knots), len(r))
        output, variable = np.tile(r, knots) + n_c * knot, np.tile(c, knots) + n_y * knot
        entry = first_value + np.arange(len(output))
        # Each value goes to every row of G that uses its output, and to every unknown its variable is made of.
        at, row, row_value = _expand(by_output.indptr, by_output.indices, by_output.data, first_output + output)
        by_variable = sp.csr_matrix(select)
        at2, col, col_value = _expand(by_variable.indptr, by_variable.indices, by_variable.data, variable[at])
        rows.append(row[at2])
        cols.append(col)
        sources.append(entry[at][at2])
        values.append(row_value[at2] * col_value)
        first_output += n_c * knots
        first_value += len(output)
    constant = sp.coo_matrix(linear)
    return _pattern(
        np.concatenate([*rows, constant.row]), np.concatenate([*cols, constant.col]),
        np.concatenate([*sources, np.full(constant.nnz, first_value)]), np.concatenate([*values, constant.data]),
        linear.shape, first_value,
    )  # fmt: skip


def hessian_pattern(triangles: Sequence[Sequence[Any]], selects: Sequence[sp.csc_matrix], weights: Array) -> Pattern:
    """Return the pattern of the upper triangle of ``sum S^T H_y S``.

    Values are, part by part, the upper nonzeros of each matrix that adds to H_y, knot by knot, and then n_y diagonal
    entries that every knot shares, times its quadrature weight.

    Args:
        triangles: CasADi sparsities of those matrices of each part.
        selects: S of each part.
        weights: (K,).
    """
    rows, cols, sources, values = [], [], [], []
    first_value, n_x = 0, selects[0].shape[1]
    for blocks, select in zip(triangles, selects, strict=True):
        n_y, knots = blocks[0].size1(), len(weights)
        left, right = [], []
        for block in blocks:
            r, c = (np.asarray(part, dtype=np.int64) for part in block.get_triplet())
            first_row = n_y * np.repeat(np.arange(knots), len(r))
            left.append(np.tile(r, knots) + first_row)
            right.append(np.tile(c, knots) + first_row)
        given, diagonal = sum(map(len, left)), np.arange(n_y * knots)
        at_left, at_right = np.concatenate([*left, diagonal]), np.concatenate([*right, diagonal])
        entry = first_value + np.concatenate([np.arange(given), given + diagonal % n_y])
        scale = np.concatenate([np.ones(given), weights[diagonal // n_y]])
        by_variable = sp.csr_matrix(select)
        at, row, row_value = _expand(by_variable.indptr, by_variable.indices, by_variable.data, at_left)
        at2, col, col_value = _expand(by_variable.indptr, by_variable.indices, by_variable.data, at_right[at])
        at, row, row_value = at[at2], row[at2], row_value[at2]
        value = scale[at] * row_value * col_value
        on_diagonal = at_left[at] == at_right[at]
        # An entry off the diagonal stands for its mirror image too; one on it gives each pair of unknowns twice.
        value[~on_diagonal & (row == col)] *= 2
        keep = ~on_diagonal | (row <= col)
        rows.append(np.minimum(row, col)[keep])
        cols.append(np.maximum(row, col)[keep])
        sources.append(entry[at][keep])
        values.append(value[keep])
        first_value += given + n_y
    row, col, source, value = (np.concatenate(part) for part in (rows, cols, sources, values))
    return _pattern(row, col, source, value, (n_x, n_x), first_value)


def _expand(starts: Index, indices: Index, data: Array, wanted: Index) -> tuple[Index, Index, Array]:
    """Return, for each entry of the wanted compressed rows, (position in ``wanted``, its index, its value)."""
    count = starts[wanted + 1] - starts[wanted]
    position = np.repeat(np.arange(len(wanted)), count)
    offset = np.arange(len(position)) - np.repeat(np.cumsum(count) - count, count)
    entry = starts[wanted][position] + offset
    return position, indices[entry], data[entry]


def _pattern(row: Index, col: Index, source: Index, value: Array, shape: tuple[int, int], n_values: int) -> Pattern:
    """Collect triplets (row, col) += value * values[source]; ``source == n_values`` means the constant part."""
    keys, nonzero = np.unique(col.astype(np.int64) * shape[0] + row, return_inverse=True)
    full = sp.csc_matrix((value, (nonzero, source)), shape=(len(keys), n_values + 1))
    indptr = np.searchsorted(keys // shape[0], np.arange(shape[1] + 1))
    matrix = sp.csc_matrix((np.ones(len(keys)), keys % shape[0], indptr), shape=shape)
    return Pattern(matrix, full[:, :n_values], np.asarray(full[:, n_values].todense()).ravel())
