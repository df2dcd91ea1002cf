"""PyTorch: gradcheck, torch.compile, the losses' flags, and plain PyTorch as an independent truth.

PyTorch is large, so it is no part of the suite's environment; to run these:

    pip install torch pytest . && python -m pytest -p no:cacheprovider tests/python/test_torch.py
"""

import sys

import numpy as np
import pytest
from conftest import ROOT, SPACING, SHAPE
from test_differentiable import KINDS, soft_body

import surfometry
from surfometry import differentiable

torch = pytest.importorskip("torch")

import surfometry.torch as st  # noqa: E402

sys.path.insert(0, str(ROOT / "benches" / "differentiable"))
import plain_torch  # noqa: E402


def stacked(image, spacing=SPACING, **options):
    return torch.stack(list(st.integrals(image, spacing, **options)), dim=-1)


def batch():
    """(2, 2, z, y, x) probabilities in double precision."""
    p = soft_body()
    return torch.from_numpy(np.stack([[p, 1 - p], [p[::-1], p[:, ::-1] ** 2]]).copy())


@pytest.mark.parametrize("name", KINDS)
def test_gradcheck(name):
    make, options = KINDS[name]
    image = torch.from_numpy(make()).requires_grad_()
    assert torch.autograd.gradcheck(lambda p: stacked(p, **options), (image,), eps=1e-5, atol=1e-4, rtol=1e-4, fast_mode=True)


@pytest.mark.parametrize("name", KINDS)
def test_operators_are_what_torch_expects(name):
    make, options = KINDS[name]
    image = torch.from_numpy(make())[None].requires_grad_()
    torch.library.opcheck(st._integrals, (image, list(SPACING), st._words(options)), atol=1e-6, rtol=1e-6)


def test_plain_torch_agrees():
    p = batch()
    options = {"embedding": "probability", "sigma": 2.3, "thickness": 3.0, "derivatives": "finite-difference"}
    weights = torch.tensor([1e-3, 1e-2, 0.1, 1.0, 1.0], dtype=p.dtype)
    found, expected = p.clone().requires_grad_(), p.clone().requires_grad_()
    ours = stacked(found, **options)
    plain = torch.stack(plain_torch.integrals(expected, SPACING, 2.3, 3.0), dim=-1)
    assert torch.allclose(ours, plain, rtol=1e-10)
    (ours * weights).sum().backward()
    (plain * weights).sum().backward()
    assert (found.grad - expected.grad).norm() < 1e-10 * expected.grad.norm()


def test_under_compile():
    p = batch().float().requires_grad_()

    def loss(p):
        found = st.integrals(torch.sigmoid(6 * p - 3), SPACING, embedding="probability")
        return (found.surface_area / 100 + found.total_squared_mean_curvature).sum()

    expected = torch.autograd.grad(loss(p), p)[0]
    compiled = torch.compile(loss, fullgraph=True, backend="aot_eager")
    assert torch.allclose(torch.autograd.grad(compiled(p), p)[0], expected, rtol=1e-5, atol=1e-8)


def test_types_and_spacings():
    p = batch()
    options = {"embedding": "probability"}
    single = st.integrals(p.float(), SPACING, **options).surface_area
    half = st.integrals(p.half(), SPACING, **options).surface_area
    assert single.dtype == half.dtype == torch.float32
    assert torch.allclose(half, single, rtol=1e-3)
    own = st.integrals(p, torch.tensor([SPACING, [2 * h for h in SPACING]], dtype=p.dtype), **options)
    assert own.total_gaussian_curvature.shape == (2, 2)
    alone = differentiable.integrals(p[1].numpy(), [2 * h for h in SPACING], **options)
    assert np.array_equal(own.surface_area[1], alone.surface_area)
    p.pixdim = torch.tensor(SPACING, dtype=p.dtype)  # what a MetaTensor knows
    assert torch.equal(st.integrals(p, **options).volume, st.integrals(p, SPACING, **options).volume)


def test_losses_and_their_flags():
    p = batch().float()
    target = (p > 0.5).float()
    weights = {"volume": 1.0, "surface_area": 0.5}
    plain = st.MorphometryLoss(weights, spacing=SPACING, reduction="none")
    each = plain(p, target)
    assert each.shape == (2, 2) and torch.all(each >= 0)
    assert torch.all(plain(target, target) == 0)
    # By hand, of one channel.
    found = st.integrals(p[1, 0], SPACING, embedding="probability")
    wanted = st.integrals(target[1, 0], SPACING, embedding="probability")
    by_hand = (found.volume / wanted.volume - 1) ** 2 + 0.5 * (found.surface_area / wanted.surface_area - 1) ** 2
    assert each[1, 0] == pytest.approx(by_hand.item(), rel=1e-4)

    def value(input, target, **flags):
        return st.MorphometryLoss(weights, spacing=SPACING, **flags)(input, target)

    assert value(p, target) == pytest.approx(each.mean().item())
    assert value(p, target, reduction="sum") == pytest.approx(each.sum().item())
    foreground = value(p, target, include_background=False, reduction="none")
    assert torch.equal(foreground, each[:, 1:])
    assert value(p, target, batch=True, reduction="none").shape == (2,)
    logits = torch.logit(p)
    assert value(logits, target, sigmoid=True) == pytest.approx(each.mean().item(), rel=1e-4)
    assert value(logits, target, other_act=torch.sigmoid) == pytest.approx(each.mean().item(), rel=1e-4)
    one_hot = torch.stack([1 - target[:, 1], target[:, 1]], dim=1)
    softmax = value(logits, one_hot, softmax=True)
    assert softmax == value(logits, target[:, 1:], softmax=True, to_onehot_y=True)
    bending = st.BendingLoss(spacing=SPACING)(p[:1, :1])
    assert 1 < bending < 3
    for loss in (st.MorphometryLoss({"total_mean_curvature": 1.0}, spacing=SPACING), plain):
        # Nothing where something is, and something where nothing is.
        for input, wanted in ((p, torch.zeros_like(p)), (torch.full_like(p, 0.01), target)):
            input = input.clone().requires_grad_()
            loss(input, wanted).sum().backward()
            assert torch.isfinite(input.grad).all()


def test_what_is_refused():
    p = batch().float()
    with pytest.raises(surfometry.InputError, match="sigmoid=True"):
        st.BendingLoss(spacing=SPACING)(torch.logit(p))
    with pytest.raises(surfometry.InputError, match="to_onehot_y"):
        st.MorphometryLoss({"volume": 1.0}, spacing=SPACING)(p, p[:, :1])
    with pytest.raises(surfometry.InputError, match="B, C"):
        st.BendingLoss(spacing=SPACING)(p[0])
    with pytest.raises(surfometry.ParameterError, match="spacing="):
        st.BendingLoss()(p)
    for arguments in ({"sigmoid": True, "softmax": True}, {"reduction": "median"}):
        with pytest.raises(surfometry.ParameterError):
            st.BendingLoss(spacing=SPACING, **arguments)
    with pytest.raises(surfometry.ParameterError, match="volume"):
        st.MorphometryLoss({"area": 1.0}, spacing=SPACING)
    twice = p.clone().double().requires_grad_()
    first = torch.autograd.grad(st.integrals(twice, SPACING, embedding="probability").surface_area.sum(), twice, create_graph=True)
    with pytest.raises(RuntimeError):
        first[0].sum().backward()


@pytest.mark.skipif(not torch.cuda.is_available(), reason="no CUDA device")
def test_tensors_of_a_device_come_back_to_it():
    p = batch().float().cuda().requires_grad_()
    found = st.integrals(p, SPACING, embedding="probability")
    found.surface_area.sum().backward()
    assert found.volume.device == p.grad.device == p.device
    assert SHAPE == tuple(p.shape[2:])
