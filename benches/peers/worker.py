"""Runs one tool on one mask twice and prints the lesser time, the memory that it needed and what it found, as JSON.

    python worker.py TOOL MASK.npy SPACING SIGMA THICKNESS
"""

import json
import math
import resource
import sys
import time

import numpy as np


def curvatures(x, y, z, xx, yy, zz, xy, xz, yz):
    """Gradient squared, H and K of a field's level sets."""
    square = x * x + y * y + z * z
    mean = x * x * (yy + zz) + y * y * (xx + zz) + z * z * (xx + yy) - 2 * (x * y * xy + x * z * xz + y * z * yz)
    gauss = x * x * (yy * zz - yz * yz) + y * y * (xx * zz - xz * xz) + z * z * (xx * yy - xy * xy)
    gauss += 2 * (x * y * (xz * yz - xy * zz) + y * z * (xy * xz - yz * xx) + x * z * (xy * yz - xz * yy))
    return square, mean / (2 * square * np.sqrt(square)), gauss / square**2


def band_integrals(phi, derivatives, sigma, thickness, h):
    """V, A, M, chi from phi and its derivatives; lengths in voxels, results in units of h."""
    epsilon = 0.5 * math.erf(thickness / (2 * math.sqrt(2) * sigma))
    x = np.clip(phi / -epsilon, -1, 1)
    volume = 0.5 * (1 + x + np.sin(np.pi * x) / np.pi).sum(dtype=np.float64)
    band = np.abs(phi) <= epsilon
    with np.errstate(divide="ignore", invalid="ignore"):
        square, mean, gauss = curvatures(*derivatives)
    area = np.where(band, (1 + np.cos(np.pi * phi / epsilon)) / (2 * epsilon), 0) * np.sqrt(square)
    total = [np.where(band, area * factor, 0).sum(dtype=np.float64) for factor in (1, mean, gauss)]
    return {"V": volume * h**3, "A": total[0] * h**2, "M": total[1] * h, "chi": total[2] / (2 * np.pi)}


def scipy_paper(mask, h, sigma, thickness):
    """The paper's method: blur, fourth-order differences, sums over the band (single precision)."""
    from scipy import ndimage

    phi = 0.5 - ndimage.gaussian_filter(mask.astype(np.float32), sigma / h)
    first = np.array([1, -8, 0, 8, -1], np.float32) / 12
    second = np.array([-1, 16, -30, 16, -1], np.float32) / 12
    along = ndimage.correlate1d
    z, y, x = (along(phi, first, axis=a) for a in range(3))
    zz, yy, xx = (along(phi, second, axis=a) for a in range(3))
    xy, xz, yz = along(x, first, axis=1), along(x, first, axis=0), along(y, first, axis=0)
    return band_integrals(phi, (x, y, z, xx, yy, zz, xy, xz, yz), sigma / h, thickness / h, h)


def itk_derivatives(mask, h, sigma, thickness):
    """ITK's recursive Gaussian, and its derivatives along all axes, then the same sums."""
    import SimpleITK as sitk

    image = sitk.GetImageFromArray(mask.astype(np.float32))

    def derivative(orders):
        result = image
        for axis, order in enumerate(orders):
            result = sitk.RecursiveGaussian(result, sigma / h, False, [0, 1, 2][order], axis)
        return sitk.GetArrayFromImage(result)

    phi = 0.5 - derivative((0, 0, 0))
    orders = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (2, 0, 0), (0, 2, 0), (0, 0, 2), (1, 1, 0), (1, 0, 1), (0, 1, 1)]
    derivatives = [-derivative(order) for order in orders]
    return band_integrals(phi, derivatives, sigma / h, thickness / h, h)


def vtk_surface(mask, h, sigma, _thickness):
    """VTK: blur, Flying Edges, mass properties, both curvatures."""
    import vtk
    from vtk.util import numpy_support

    image = vtk.vtkImageData()
    image.SetDimensions(mask.shape[::-1])
    image.SetSpacing(h, h, h)
    image.GetPointData().SetScalars(numpy_support.numpy_to_vtk(mask.astype(np.float32).ravel(), deep=True))
    smooth = vtk.vtkImageGaussianSmooth()
    smooth.SetInputData(image)
    smooth.SetDimensionality(3)
    smooth.SetStandardDeviations(*[sigma / h] * 3)
    smooth.SetRadiusFactors(4, 4, 4)
    surface = vtk.vtkFlyingEdges3D()
    surface.SetInputConnection(smooth.GetOutputPort())
    surface.SetValue(0, 0.5)
    surface.ComputeNormalsOff()
    surface.Update()
    properties = vtk.vtkMassProperties()
    properties.SetInputConnection(surface.GetOutputPort())
    properties.Update()
    for kind in (vtk.VTK_CURVATURE_MEAN, vtk.VTK_CURVATURE_GAUSS):
        curvature = vtk.vtkCurvatures()
        curvature.SetInputConnection(surface.GetOutputPort())
        curvature.SetCurvatureType(kind)
        curvature.Update()
    return {"V": properties.GetVolume(), "A": properties.GetSurfaceArea()}


def scikit_image(mask, h, _sigma, _thickness):
    """scikit-image: marching cubes of the mask, its area, and the Euler number."""
    from skimage import measure

    vertices, faces, _, _ = measure.marching_cubes(mask, 0.5, spacing=(h, h, h))
    area = measure.mesh_surface_area(vertices, faces)
    return {"V": float(mask.sum()) * h**3, "A": float(area), "chi": 2.0 * measure.euler_number(mask, 3)}


def diplib_area(mask, h, _sigma, _thickness):
    """DIPlib: size and surface area of a label."""
    import diplib as dip

    image = dip.Image(mask)
    image.SetPixelSize(dip.PixelSize(h * dip.Units("mm")))
    found = dip.MeasurementTool.Measure(image, image, ["Size", "SurfaceArea"])
    return {"V": found[1]["Size"][0], "A": found[1]["SurfaceArea"][0]}


def karambola(mask, h, _sigma, _thickness):
    """pykarambola: Minkowski functionals of the mask's triangulation."""
    import pykarambola

    found = pykarambola.minkowski_tensors_from_label_image(
        mask.astype(np.int32), spacing=(h, h, h), compute=["w000", "w100", "w200", "w300"], compute_eigensystems=False
    )
    first = next(iter(found.values())) if isinstance(found, dict) and "w000" not in found else found
    return {"V": float(first["w000"]), "A": 3 * float(first["w100"])}


def quantimpy_counting(mask, h, _sigma, _thickness):
    """quantimpy: all functionals from counting 2 x 2 x 2 neighbourhoods; no local result."""
    import quantimpy.minkowski as minkowski

    volume, area, _length, euler = minkowski.functionals(mask.astype(bool), np.array([h, h, h]))
    return {"V": volume, "A": 8 * area, "chi": 16 * np.pi * euler}


def pyradiomics_shape(mask, h, _sigma, _thickness):
    """PyRadiomics: the shape features of a mask."""
    import SimpleITK as sitk
    from radiomics import shape

    image = sitk.GetImageFromArray(mask)
    image.SetSpacing((h, h, h))
    features = shape.RadiomicsShape(image, image)
    features.enableAllFeatures()
    found = features.execute()
    return {"V": float(found["MeshVolume"]), "A": float(found["SurfaceArea"])}


TOOLS = {
    "scipy": scipy_paper,
    "itk": itk_derivatives,
    "vtk": vtk_surface,
    "scikit-image": scikit_image,
    "diplib": diplib_area,
    "pykarambola": karambola,
    "quantimpy": quantimpy_counting,
    "pyradiomics": pyradiomics_shape,
}


def peak_mib():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main():
    tool, path, *numbers = sys.argv[1:]
    h, sigma, thickness = map(float, numbers)
    mask = np.load(path)
    TOOLS[tool](mask[:24, :24, :24] if mask[:24, :24, :24].any() else np.pad(np.ones((6, 6, 6), np.uint8), 9), h, sigma, thickness)
    before, seconds = peak_mib(), []
    for _ in range(2):
        start = time.perf_counter()
        found = TOOLS[tool](mask, h, sigma, thickness)
        seconds.append(time.perf_counter() - start)
    print(json.dumps({"seconds": min(seconds), "mib": peak_mib() - before, **found}))


if __name__ == "__main__":
    main()
