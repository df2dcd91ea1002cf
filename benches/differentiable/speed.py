"""Forward and backward against plain PyTorch on the CPU: time and peak memory.

    a/bin/python benches/differentiable/speed.py [--size 128] [--runs 5]

Needs torch and the package in one environment. Runs are interleaved; each program's memory is that of a process of its own,
less what it has before the first call.
"""

import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import time

import torch

import surfometry.torch

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import plain_torch

SPACING = (1.2, 0.8, 0.9)
SIGMA, THICKNESS = 2.1, 3.0
WEIGHTS = torch.tensor([1e-3, 1e-2, 1e-1, 1.0, 1.0])


def image(size):
    """A lumpy, turned body in float32, its soft edge about two voxels wide."""
    z, y, x = torch.meshgrid(*[(torch.arange(size) - size / 2 + 0.3) * h for h in SPACING], indexing="ij")
    u, v = 0.8 * x + 0.6 * y, -0.6 * x + 0.8 * y
    r = size * 0.3
    radius = ((u / r) ** 2 + (v / (0.9 * r)) ** 2 + (z / (1.2 * r)) ** 2).sqrt()
    field = radius - 1 + 0.06 * torch.sin(u / 5) * torch.cos(z / 6)
    return torch.sigmoid(-field * r / 0.8)[None, None].float()


def ours(derivatives):
    def run(p):
        found = surfometry.torch.integrals(
            p, SPACING, embedding="probability", sigma=SIGMA, thickness=THICKNESS, derivatives=derivatives
        )
        return torch.stack(list(found), dim=-1)

    return run


PROGRAMS = {
    "plain torch": lambda p: torch.stack(plain_torch.integrals(p, SPACING, SIGMA, THICKNESS), dim=-1),
    "surfometry, the same differences": ours("finite-difference"),
    "surfometry, matched differences": ours("matched"),
}


def forward_and_backward(program, p):
    p = p.clone().requires_grad_()
    start = time.perf_counter()
    values = program(p)
    forward = time.perf_counter() - start
    (values * WEIGHTS).sum().backward()
    return forward, time.perf_counter() - start, values.detach(), p.grad


def peak(name, size):
    """MiB of a process that runs one program once."""
    code = [sys.executable, __file__, "--size", str(size), "--alone", name]
    return json.loads(subprocess.run(code, capture_output=True, text=True, check=True).stdout)


def resident():
    """The most that this process has held, MiB. (Linux; what getrusage says is inherited from whoever started it.)"""
    lines = pathlib.Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM")) / 1024


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--size", type=int, default=128)
    arguments.add_argument("--runs", type=int, default=5)
    arguments.add_argument("--alone")
    given = arguments.parse_args()
    p = image(given.size)
    if given.alone:
        forward_and_backward(PROGRAMS[given.alone], p[..., :32, :32, :32].contiguous())
        before = resident()
        forward_and_backward(PROGRAMS[given.alone], p)
        print(json.dumps(resident() - before))
        return
    times = {name: [] for name in PROGRAMS}
    results = {}
    for _ in range(given.runs + 1):
        for name, program in PROGRAMS.items():
            *seconds, values, gradient = forward_and_backward(program, p)
            times[name].append(seconds)
            results[name] = values, gradient
    print(f"{given.size}^3, float32, {torch.get_num_threads()} threads, median of {given.runs}; torch {torch.__version__}")
    plain = statistics.median(both for _, both in times["plain torch"][1:])
    for name, seconds in times.items():
        forward = statistics.median(forward for forward, _ in seconds[1:])
        both = statistics.median(both for _, both in seconds[1:])
        print(f"{name:34} forward {forward:.3f} s, with backward {both:.3f} s, {plain / both:5.1f} x; peak {peak(name, given.size):.0f} MiB")
    expected, found = results["plain torch"], results["surfometry, the same differences"]
    print("values differ by", ((found[0] - expected[0]) / expected[0]).abs().max().item(), "at most")
    print("gradients differ by", ((found[1] - expected[1]).norm() / expected[1].norm()).item())


if __name__ == "__main__":
    main()
