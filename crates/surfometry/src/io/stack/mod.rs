//! Stacks of pages: TIFF files of many, and folders of slices, each a TIFF or PNG file.

mod description;
mod folder;
mod page;
mod png_page;
mod tiff_pages;

pub(super) use folder::{holds_slices, read_header as read_folder};
pub(super) use tiff_pages::read_header as read_tiff;
