"""Measures a segmentation of 3D Slicer, from its Python console: a table, and a model a segment with curvature on it.

Slicer 5.10 or later, whose Python is 3.12: ``slicer.util.pip_install("surfometry")``, then ``exec(open("slicer.py").read())``
and ``measure_segmentation(getNode("Segmentation"))``. Without a file: paste it.
"""

import csv
import pathlib
import tempfile

import surfometry


def image_of(voxels, ijk_to_ras, names):
    """A label map as Slicer has it, as an image.

    Parameters
    ----------
    voxels : (K, J, I) array
        ``slicer.util.arrayFromVolume``: axes k, j, i.
    ijk_to_ras : (4, 4) array
        From index (i, j, k) to RAS, mm.
    names : list of str
        Names of the segments, in the order of their labels 1, 2, ...
    """
    rows = [[float(value) for value in row] for row in ijk_to_ras[:3]]
    return surfometry.Image(voxels, "zyx", rows, "segmentation", dict(enumerate(names, 1)), "RAS")


def write_table(columns, path):
    """Writes columns of `measure_labels` as Slicer's tables have them: the segment's name first, a row a segment."""
    shown = ["name", *(name for name in columns if name not in ("index", "input", "name"))]
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["Segment", *shown[1:]])
        writer.writerows(zip(*(columns[name] for name in shown), strict=True))


def measure_segmentation(segmentation, models=True):
    """Adds a table of all visible segments to the scene, and their surfaces coloured by mean curvature, 1/mm.

    A transform above the segmentation has to be hardened first: lengths are those of the voxels.
    """
    import slicer
    import vtk

    labelmap = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLLabelMapVolumeNode")
    slicer.modules.segmentations.logic().ExportVisibleSegmentsToLabelmapNode(segmentation, labelmap)
    names = vtk.vtkStringArray()
    segmentation.GetDisplayNode().GetVisibleSegmentIDs(names)
    segments = [segmentation.GetSegmentation().GetSegment(names.GetValue(n)).GetName() for n in range(names.GetNumberOfValues())]
    matrix = vtk.vtkMatrix4x4()
    labelmap.GetIJKToRASMatrix(matrix)
    image = image_of(slicer.util.arrayFromVolume(labelmap), slicer.util.arrayFromVTKMatrix(matrix), segments)
    columns = surfometry.measure_labels(image, as_frame=False)
    with tempfile.TemporaryDirectory() as folder:
        table = pathlib.Path(folder) / "surfaces.csv"
        write_table(columns, table)
        slicer.util.loadTable(str(table))
        for label, name in zip(columns["label"], columns["name"], strict=True) if models else ():
            # The file says that it is RAS, which Slicer reads.
            mesh = pathlib.Path(folder) / f"{label}.vtp"
            surfometry.surface(image, label=label).save(mesh)
            model = slicer.util.loadModel(str(mesh))
            model.SetName(name)
            model.GetDisplayNode().SetActiveScalar("mean_curvature_per_mm", vtk.vtkAssignAttribute.POINT_DATA)
            model.GetDisplayNode().SetScalarVisibility(True)
    slicer.mrmlScene.RemoveNode(labelmap)
