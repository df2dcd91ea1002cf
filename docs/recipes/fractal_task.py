"""A task for Fractal, or for any OME-Zarr: surfaces of a label image as a feature table beside it.

``pip install surfometry pandas ngio``.
"""

from ngio import FeatureTable, open_ome_zarr_container

import surfometry

MILLIMETRES = {"nanometer": 1e-6, "micrometer": 1e-3, "millimeter": 1.0}


def measure_surfaces(
    *, zarr_url: str, label_name: str, table_name: str = "surfaces", threads: int = 1, overwrite: bool = False
) -> None:
    """Measures all labels of a label image at its full resolution.

    Args:
        zarr_url: The image, an OME-Zarr of version 0.4 or 0.5.
        label_name: Which of its label images.
        table_name: Name of the table: a row a label, columns as of `surfometry.measure_labels`, lengths in mm.
        threads: One, where a scheduler runs a task a core.
        overwrite: Whether a table of that name is replaced.
    """
    container = open_ome_zarr_container(zarr_url)
    labels = container.get_label(label_name)
    size, millimetres = labels.pixel_size, MILLIMETRES[labels.space_unit]
    spacing = [length * millimetres for length in (size.z, size.y, size.x)]
    table = surfometry.measure_labels(labels.get_as_numpy(axes_order=["z", "y", "x"]), spacing, name=label_name, threads=threads)
    features = table.drop(columns="index").dropna(axis="columns", how="all").set_index("label")
    # CSV keeps all digits; the back end of AnnData would make floats of 32 bits of them.
    container.add_table(table_name, FeatureTable(features, reference_label=label_name), backend="csv", overwrite=overwrite)
