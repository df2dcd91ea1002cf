//! How much of a page an object may take, so that pages of many objects stay small.

/// Triangles of all surfaces of a page, and of one.
const TRIANGLES: usize = 640_000;
const TRIANGLES_OF_ONE: usize = 240_000;
/// Pixels of all slices of a page, and of one object's.
const PIXELS: usize = 4_000_000;
const PIXELS_OF_ONE: usize = 2_400_000;
/// Voxels on the wrong side that are shown, of a page and of an object.
const WRONG: usize = 200_000;
const WRONG_OF_ONE: usize = 20_000;
/// Sides of thumbnails: of so few objects, and of more.
const FEW: usize = 150;
const THUMBNAIL_OF_FEW: usize = 200;
const THUMBNAIL: usize = 96;
/// Most objects of a page that are looked at closely.
const CLOSE: usize = 8;

/// Objects from which on a page is told to be large, and what each takes of it at least, bytes.
const MANY: usize = 2000;
const OF_OBJECT: usize = 24_000;

/// What one of so many objects may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PageShare {
    /// Objects of the page, as far as that is known before.
    pub(super) objects: usize,
}

impl PageShare {
    fn part(self, all: usize, of_one: usize) -> usize {
        (all / self.objects.max(1)).min(of_one)
    }

    pub(super) fn triangles(self) -> usize {
        self.part(TRIANGLES, TRIANGLES_OF_ONE)
    }

    pub(super) fn pixels(self) -> usize {
        self.part(PIXELS, PIXELS_OF_ONE)
    }

    pub(super) fn wrong_voxels(self) -> usize {
        self.part(WRONG, WRONG_OF_ONE)
    }

    /// Pixels along a thumbnail's side.
    pub(super) fn thumbnail(self) -> usize {
        if self.objects <= FEW { THUMBNAIL_OF_FEW } else { THUMBNAIL }
    }

    /// How large the page becomes, where that is told before.
    pub(super) fn large_megabytes(self) -> Option<usize> {
        (self.objects > MANY).then_some(self.objects * OF_OBJECT / 1_000_000)
    }

    /// Whether objects are measured at other blurs too, which takes as long as measuring ten, and mapped at a scale of
    /// each place where no other was asked for.
    pub(super) fn looks_closely(self) -> bool {
        self.objects <= CLOSE
    }
}
