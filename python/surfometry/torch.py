"""Integrals over surfaces as PyTorch functions and losses; needs ``torch`` 2.4 or later (``pip install surfometry[torch]``).

>>> import torch, surfometry.torch  # doctest: +SKIP
>>> loss = surfometry.torch.MorphometryLoss({"surface_area": 1.0}, spacing=(2.0, 0.8, 0.8), sigmoid=True)  # doctest: +SKIP
>>> loss(logits, target).backward()  # doctest: +SKIP

Images are (B, C, z, y, x), every channel an object of its own. The work is done on the CPU, in the library, by
`surfometry.differentiable`; tensors of another device are copied to it and back. docs/differentiable.md says what the
numbers mean.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import torch
from torch import Tensor

from . import differentiable
from ._errors import InputError, ParameterError
from .differentiable import Integrals, Spacing

__all__ = ["BendingLoss", "MorphometryLoss", "integrals"]


@torch.library.custom_op("surfometry::integrals", mutates_args=(), device_types=None)
def _integrals(image: Tensor, spacing: list[float], options: str) -> Tensor:
    found = differentiable.integrals(_on_host(image), _array_of(spacing, image), **_options(options))
    return torch.from_numpy(np.stack(found, axis=-1)).to(image)


@torch.library.custom_op("surfometry::integrals_vjp", mutates_args=(), device_types=None)
def _integrals_vjp(image: Tensor, weights: Tensor, spacing: list[float], options: str) -> Tensor:
    by_name = Integrals(*np.moveaxis(_on_host(weights), -1, 0))
    gradient = differentiable.vjp(_on_host(image), by_name, _array_of(spacing, image), **_options(options))
    return torch.from_numpy(gradient).to(image)


@_integrals.register_fake
def _(image: Tensor, spacing: list[float], options: str) -> Tensor:
    return image.new_empty((*image.shape[:-3], 5))


@_integrals_vjp.register_fake
def _(image: Tensor, weights: Tensor, spacing: list[float], options: str) -> Tensor:
    return torch.empty_like(image, memory_format=torch.contiguous_format)


def _remember(ctx: Any, inputs: tuple[Any, ...], output: Tensor) -> None:
    image, ctx.spacing, ctx.options = inputs
    ctx.save_for_backward(image)


def _backward(ctx: Any, weights: Tensor) -> tuple[Tensor, None, None]:
    (image,) = ctx.saved_tensors
    return _integrals_vjp(image, weights, ctx.spacing, ctx.options), None, None


_integrals.register_autograd(_backward, setup_context=_remember)


def _on_host(tensor: Tensor) -> Any:
    return tensor.detach().cpu().contiguous().numpy()


def _words(options: Mapping[str, Any]) -> str:
    """Options as one text, which is what an operator may take. (Without JSON, which ``torch.compile`` cannot trace.)"""
    return ",".join(f"{name}={value}" for name, value in options.items() if value is not None)


def _options(words: str) -> dict[str, Any]:
    """Options of such a text, in words, which `differentiable` takes for numbers."""
    return dict(part.split("=", 1) for part in words.split(","))


def _array_of(spacing: list[float], image: Tensor) -> Any:
    """The spacing as it was before it was flattened: three lengths, or three for each image of the batch."""
    lengths = np.array(spacing)
    if lengths.size == 3:
        return lengths
    return lengths.reshape(image.shape[0], *([1] * (image.ndim - 4)), 3)


def integrals(image: Tensor, spacing: Spacing | None = None, *, embedding: str, **options: Any) -> Integrals:
    """Volume, area and curvature of the surfaces in images, with gradients.

    A `torch.library.custom_op`: it works under ``torch.compile``. There are first derivatives only.

    Parameters
    ----------
    image : Tensor, shape (..., z, y, x)
        As of `surfometry.differentiable.integrals`. Half precision is taken as float32.
    spacing : float, three floats, or (B, 3), optional
        mm, in the order of the three last axes; by default the ``pixdim`` of a MONAI MetaTensor.
    embedding, **options
        As of `surfometry.differentiable.integrals`.

    Returns
    -------
    Integrals
        Tensors of the leading axes' shape, on the device and of the type of the image.
    """
    lengths = _lengths(_spacing(spacing, image))
    if not image.dtype.is_floating_point or image.dtype.itemsize < 4:
        image = image.float()
    found = _integrals(image, lengths, _words({"embedding": embedding, **options}))
    return Integrals(*found.unbind(-1))


def _spacing(spacing: Spacing | None, *tensors: Tensor | None) -> Any:
    """What was said, else what a MetaTensor knows."""
    known = (getattr(tensor, "pixdim", None) for tensor in tensors)
    found = spacing if spacing is not None else next((own for own in known if own is not None), None)
    if found is None:
        hint = "spacing=, in mm, in the order of the three last axes"
        raise ParameterError(f"no voxel spacing is known: say what it is ({hint})", field="spacing", hint=hint)
    return found


def _lengths(spacing: Any) -> list[float]:
    """Three lengths, or three an image, in a row. (Without NumPy, which ``torch.compile`` takes for tensors.)"""
    given = spacing.tolist() if isinstance(spacing, (Tensor, np.ndarray)) else spacing
    try:
        if isinstance(given, (int, float)):
            return [float(given)] * 3
        rows = [row if isinstance(row, (list, tuple)) else [row] for row in given]
        lengths = [float(length) for row in rows for length in row]
    except (TypeError, ValueError):
        lengths = []
    if not lengths or len(lengths) % 3:
        message = f"spacing={spacing!r}: three numbers in mm, in the order of the last three axes, one for all, or (B, 3)"
        raise ParameterError(message, field="spacing")
    return lengths


class _Loss(torch.nn.Module):
    """What the losses have in common: channels, activations, reduction, by MONAI's names."""

    def __init__(
        self,
        weights: Mapping[str, float],
        *,
        spacing: Spacing | None = None,
        include_background: bool = True,
        to_onehot_y: bool = False,
        sigmoid: bool = False,
        softmax: bool = False,
        other_act: Callable[[Tensor], Tensor] | None = None,
        reduction: str = "mean",
        batch: bool = False,
        **options: Any,
    ) -> None:
        super().__init__()
        unknown = weights.keys() - set(Integrals._fields)
        if unknown or not weights:
            known = ", ".join(Integrals._fields)
            raise ParameterError(f"weights of {', '.join(sorted(unknown)) or 'nothing'}: there are {known}", field="weights")
        if sum((sigmoid, softmax, other_act is not None)) > 1:
            raise ParameterError("sigmoid, softmax and other_act exclude each other: leave all but one out", field="sigmoid")
        if reduction not in ("none", "mean", "sum"):
            raise ParameterError(f'reduction={reduction!r}: "none", "mean" or "sum"', field="reduction")
        self.weights = dict(weights)
        self.spacing = spacing
        self.include_background = include_background
        self.to_onehot_y = to_onehot_y
        self.activation = torch.sigmoid if sigmoid else _softmax if softmax else other_act
        self.reduction = reduction
        self.batch = batch
        self.options = options

    def _prediction(self, input: Tensor) -> Tensor:
        if input.ndim != 5:
            raise InputError(f"an input of shape {tuple(input.shape)}: it is (B, C, z, y, x)", field="input")
        probabilities = input if self.activation is None else self.activation(input)
        return self._channels(probabilities)

    def _truth(self, target: Tensor, input: Tensor) -> Tensor:
        if self.to_onehot_y:
            classes = torch.nn.functional.one_hot(target[:, 0].long(), input.shape[1])
            target = classes.movedim(-1, 1)
        if target.shape != input.shape:
            raise InputError(
                f"a target of shape {tuple(target.shape)} for an input of {tuple(input.shape)}; to_onehot_y=True makes "
                "channels of a target of labels (B, 1, z, y, x)",
                field="target",
            )
        return self._channels(target.to(input.dtype))

    def _channels(self, image: Tensor) -> Tensor:
        return image if self.include_background or image.shape[1] == 1 else image[:, 1:]

    def _integrals(self, image: Tensor, spacing: Any) -> Integrals:
        try:
            found = integrals(image, spacing, embedding="probability", **self.options)
        except InputError as error:
            if self.activation is None:
                raise InputError(f"{error}; of logits say sigmoid=True or softmax=True", field="input") from error
            raise
        if self.batch:
            return Integrals(*(of_image.sum(dim=0) for of_image in found))
        return found

    def _reduced(self, loss: Tensor) -> Tensor:
        if self.reduction == "none":
            return loss
        return loss.mean() if self.reduction == "mean" else loss.sum()


def _softmax(input: Tensor) -> Tensor:
    return torch.softmax(input, dim=1)


class MorphometryLoss(_Loss):
    """Squared differences of a prediction's integrals from a target's, relative to the target's size.

    The sum over ``weights`` of weight times ((integral - integral of the target) / scale)². The scale of V and A is the
    target's own, that of the others what a ball of the target's area has: sqrt(4 pi A) of the integral of H, 4 pi of those
    of K and H². Below a ball of one voxel it is that ball's, so that an empty target is no division by 0. Target and
    prediction are blurred alike, so that no bias of the blur is in it.

    Parameters
    ----------
    weights : mapping
        Weights by the names of `surfometry.differentiable.Integrals`.
    spacing : float, three floats, or (B, 3), optional
        mm, in the order of the spatial axes; by default that of a MetaTensor.
    include_background : bool
        False leaves channel 0 out, where there are several.
    to_onehot_y : bool
        Whether the target is labels, (B, 1, z, y, x).
    sigmoid, softmax, other_act : bool, bool, callable
        What makes probabilities of the input. Without one the input must be probabilities: values beyond 0 and 1 raise.
    reduction : {"mean", "sum", "none"}
        Over images and channels; ``"none"`` gives (B, C).
    batch : bool
        Whether integrals are added up over the batch before they are compared; ``"none"`` gives (C,) then.
    **options
        As of `surfometry.differentiable.integrals`, ``sigma`` and ``thickness`` among them.
    """

    def forward(self, input: Tensor, target: Tensor) -> Tensor:
        """The loss of an input and a target, both (B, C, z, y, x)."""
        spacing = _spacing(self.spacing, input, target)
        found = self._integrals(self._prediction(input), spacing)
        with torch.no_grad():
            wanted = self._integrals(self._truth(target, input), spacing)
        scales = _scales(wanted, max(_lengths(spacing)))
        loss = torch.zeros_like(found.volume)
        for name, weight in self.weights.items():
            loss = loss + weight * ((getattr(found, name) - getattr(wanted, name)) / getattr(scales, name)) ** 2
        return self._reduced(loss)


def _scales(wanted: Integrals, voxel: float) -> Integrals:
    """Sizes by which differences are told from nothing, mm."""
    area = wanted.surface_area.clamp(min=4 * math.pi * voxel**2)
    volume = wanted.volume.clamp(min=4 / 3 * math.pi * voxel**3)
    whole = torch.full_like(area, 4 * math.pi)
    return Integrals(volume, area, (4 * math.pi * area).sqrt(), whole, whole)


class BendingLoss(_Loss):
    """How bent the surfaces of a prediction are: the integral of H² over 4 pi, 1 of any ball, less only of none.

    It has no length in it, so that it does not shrink what it smooths. Two balls have 2, a torus at least pi / 2.

    Parameters
    ----------
    spacing, include_background, sigmoid, softmax, other_act, reduction, batch, **options
        As of `MorphometryLoss`.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__({"total_squared_mean_curvature": 1.0}, **options)

    def forward(self, input: Tensor, target: Tensor | None = None) -> Tensor:
        """The loss of an input (B, C, z, y, x); a target is not looked at."""
        found = self._integrals(self._prediction(input), _spacing(self.spacing, input))
        return self._reduced(found.total_squared_mean_curvature / (4 * math.pi))
