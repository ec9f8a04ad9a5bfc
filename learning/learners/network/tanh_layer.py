"""Hidden layer of tanh units, summed over symmetric copies: values and derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TanhLayer:
    """The network ``N(x) = V tanh(W x + b) + c``, averaged over copies of its input.

    With copies x_g of one input and signs Y_g the k-th output is

        f_k = 1/G sum_g Y_gk N_k(x_g)

    (G = 1, Y = 1: the plain network). Moving the input by a relation permutes the copies and
    multiplies by one sign: f has the symmetry whatever the parameters.

    Attributes
    ----------
    inputs, hidden, outputs : int
        Numbers of inputs f, hidden units H and outputs k.
    signs : (G, k) array
        Y.

    Notes
    -----
    Parameters are one vector: [W, b] (H rows of f + 1), then [V, c] (k rows of H + 1). Outputs
    with the same signs share the derivatives of their copies.
    """

    inputs: int
    hidden: int
    outputs: int
    signs: Array

    @property
    def size(self) -> int:
        """Number of parameters."""
        return self.hidden * (self.inputs + 1) + self.outputs * (self.hidden + 1)

    def initial(self, rng: np.random.Generator) -> Array:
        """Random parameters, (size,), for inputs within [-1, 1] and outputs of size 1.

        Hidden units bend in different places of the cube of inputs [1]_, a little less steeply
        than there: inputs on circles do not fill the cube.

        References
        ----------
        .. [1] D. Nguyen, B. Widrow, "Improving the learning speed of 2-layer neural networks by
           choosing initial values of the adaptive weights", IJCNN 1990.
        """
        steep = 0.5 * self.hidden ** (1 / self.inputs)
        W = rng.normal(size=(self.hidden, self.inputs))
        W *= steep / np.linalg.norm(W, axis=1, keepdims=True)
        b = steep * rng.permutation(np.linspace(-1, 1, self.hidden))
        V = 0.1 * rng.normal(size=(self.outputs, self.hidden + 1))
        V[:, -1] = 0.0
        return np.concatenate([np.column_stack([W, b]).ravel(), V.ravel()])

    def split(self, parameters: Array) -> tuple[Array, Array]:
        """Views [W, b] (H, f + 1) and [V, c] (k, H + 1) of the parameters."""
        inner = self.hidden * (self.inputs + 1)
        return (
            parameters[:inner].reshape(self.hidden, self.inputs + 1),
            parameters[inner:].reshape(self.outputs, self.hidden + 1),
        )

    def values(self, parameters: Array, x: Array) -> Array:
        """Outputs (m, k) for copies x (m, G, f) of m inputs."""
        W, V = self.split(parameters)
        units = np.tanh(x @ W[:, :-1].T + W[:, -1])
        copies = units @ V[:, :-1].T + V[:, -1]
        return np.asarray(np.einsum("mgk,gk->mk", copies, self.signs) / len(self.signs))

    def derivatives(self, parameters: Array, x: Array) -> tuple[Array, Array]:
        """Outputs (m, k) and their derivatives (m, k, size) with respect to the parameters."""
        W, V = self.split(parameters)
        m = len(x)
        units = np.tanh(x @ W[:, :-1].T + W[:, -1])
        slopes = (1 - units**2).transpose(0, 2, 1)
        with_one = np.concatenate([x, np.ones((*x.shape[:2], 1))], axis=2)
        inner = W.size
        values = np.empty((m, self.outputs))
        result = np.zeros((m, self.outputs, self.size))
        for signs, members in self._classes():
            weight = signs / len(signs)
            layer = slopes @ (weight[:, None] * with_one)
            mean = np.concatenate([weight @ units, np.full((m, 1), weight.sum())], axis=1)
            for k in members:
                result[:, k, :inner] = (V[k, :-1, None] * layer).reshape(m, -1)
                start = inner + k * (self.hidden + 1)
                result[:, k, start : start + self.hidden + 1] = mean
                values[:, k] = mean @ V[k]
        return values, result

    def input_derivatives(self, parameters: Array, x: Array, dx: Array) -> Array:
        """Derivatives (m, k, r) by coordinates, given those of the copies, dx (m, G, f, r)."""
        W, V = self.split(parameters)
        slopes = 1 - np.tanh(x @ W[:, :-1].T + W[:, -1]) ** 2
        weights = np.einsum("gk,kh,mgh->mgkh", self.signs, V[:, :-1], slopes)
        gradients = weights @ W[:, :-1] / len(self.signs)
        return np.asarray(np.einsum("mgkf,mgfr->mkr", gradients, dx))

    def _classes(self) -> list[tuple[Array, NDArray[np.int64]]]:
        """Distinct columns of signs and the outputs that have them."""
        columns, member = np.unique(self.signs.T, axis=0, return_inverse=True)
        return [(c, np.flatnonzero(member.ravel() == i)) for i, c in enumerate(columns)]
