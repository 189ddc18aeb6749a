//! How boxes are parted: in two, and the halves in two again, where the sum of surfaces times the leaves within is least (the surface area
//! heuristic, in bins: Wald 2007, "On fast construction of SAH-based bounding volume hierarchies"); and how many of the parts are best put
//! side by side in a node (dynamic programming after Ylitie, Karras, Laine 2017, "Efficient incoherent ray traversal on GPUs through
//! compressed wide BVHs", section 3.1).

use bytemuck::{Pod, Zeroable};
use glam::{Vec3A, Vec4};
use rayon::prelude::*;

use super::bounds::Bounds;
use super::node::WIDTH;
use super::pages::Pages;
use crate::raycast::RaycastError;

/// A box and its number.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Item {
    /// Lowest corner, and the bits of the number.
    low: Vec4,
    high: Vec4,
}

impl Item {
    pub fn new(Bounds { low, high }: Bounds, index: u32) -> Self {
        // As a float the number is a denormal one, with which processors are slow to multiply: so centres get a fourth component of 1.
        Self { low: low.extend(f32::from_bits(index)), high: high.extend(1.0) }
    }

    #[inline]
    pub fn bounds(&self) -> Bounds {
        Bounds { low: Vec3A::from_vec4(self.low), high: Vec3A::from_vec4(self.high) }
    }

    #[inline]
    pub fn index(&self) -> u32 {
        self.low.w.to_bits()
    }

    /// Twice the centre.
    #[inline]
    fn centre(&self) -> Vec3A {
        let Bounds { low, high } = self.bounds();
        low + high
    }
}

/// Two boxes or more. What is below the first half follows, as far as it is parts and not single boxes, and then what is below the second.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Part {
    low: [f32; 3],
    /// Boxes in the first half.
    left: u32,
    high: [f32; 3],
    /// By i: how it is cut if it may become i + 1 children of a node at most; of one child, how what is below is cut into eight at most.
    cuts: [Cut; WIDTH],
}

/// Boxes as they have been parted, in their order.
pub struct Parted<'a> {
    items: &'a [Item],
    parts: Pages<Part>,
}

/// A part, or a single box, by place.
#[derive(Clone, Copy)]
pub struct Place {
    part: usize,
    first: usize,
    pub count: usize,
}

impl Parted<'_> {
    /// All boxes.
    pub fn whole(&self) -> Place {
        Place { part: 0, first: 0, count: self.items.len() }
    }

    /// The boxes of a part.
    pub fn items(&self, Place { first, count, .. }: Place) -> &[Item] {
        &self.items[first..first + count]
    }

    pub fn bounds(&self, place: Place) -> Bounds {
        if let [item] = self.items(place) {
            return item.bounds();
        }
        let Part { low, high, .. } = self.parts[place.part];
        Bounds { low: low.into(), high: high.into() }
    }

    /// How a part is cut if it may become `most` children of a node, as [`Part::cuts`] says.
    pub fn cut(&self, place: Place, most: usize) -> Cut {
        if place.count > 1 { self.parts[place.part].cuts[most - 1] } else { Cut::NONE }
    }

    /// The halves of a part.
    pub fn halves(&self, Place { part, first, count }: Place) -> [Place; 2] {
        let left = self.parts[part].left as usize;
        let before = Place { part: part + 1, first, count: left };
        [before, Place { part: part + left, first: first + left, count: count - left }]
    }
}

/// How many children each half of a part becomes at most; nothing if the part remains whole.
#[derive(Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Cut(u8);

impl Cut {
    /// It remains whole.
    pub const NONE: Self = Self(0);

    fn new(left: usize, right: usize) -> Self {
        Self((left | right << 4) as u8)
    }

    pub fn halves(self) -> Option<[usize; 2]> {
        let Self(both) = self;
        (both != 0).then_some([usize::from(both & 0xf), usize::from(both >> 4)])
    }
}

/// Boxes of which it is worth while to part the halves at the same time.
const PARALLEL: usize = 1 << 12;

/// Parts `items`, of which there is at least one. Of items up to `capacity` a leaf can be made. After `levels`, parts are cut in the
/// middle, whatever that costs.
///
/// # Errors
/// If there is no memory.
pub fn partition(items: &mut [Item], capacity: usize, levels: u32) -> Result<Parted<'_>, RaycastError> {
    let mut parts: Pages<Part> = Pages::zeroed(items.len() - 1)?;
    Partition { capacity }.divide(items, &mut parts, levels, &mut NO_BINS.clone());
    Ok(Parted { items, parts })
}

/// By part: the least cost if it may become at most 1, 2, …, 8 children of a node. Looking into a node costs as much as looking
/// into a leaf, and is as likely as its surface is large.
type Costs = [f32; WIDTH];

struct Partition {
    capacity: usize,
}

impl Partition {
    /// Parts `items` into `parts`, of which there is one less, and says what is around them and what they cost. `bins` are for use on the way.
    fn divide(
        &self,
        items: &mut [Item],
        parts: &mut [Part],
        levels: u32,
        bins: &mut Bins,
    ) -> (Bounds, Costs) {
        let Some((part, parts)) = parts.split_first_mut() else {
            let bounds = items[0].bounds();
            return (bounds, [bounds.half_area(); WIDTH]);
        };
        let count = items.len();
        let middle = if levels > 0 { split(items, self.capacity, bins) } else { count / 2 };
        let levels = levels.saturating_sub(1);
        let (left, right) = items.split_at_mut(middle);
        let (below_left, below_right) = parts.split_at_mut(middle - 1);
        let mut divide_left = |bins: &mut Bins| self.divide(left, below_left, levels, bins);
        let mut divide_right = |bins: &mut Bins| self.divide(right, below_right, levels, bins);
        let ((low, left), (high, right)) = if count > PARALLEL {
            rayon::join(|| divide_left(bins), || divide_right(&mut NO_BINS.clone()))
        } else {
            (divide_left(bins), divide_right(bins))
        };
        let bounds = low.union(high);
        let leaf = if count <= self.capacity { bounds.half_area() } else { f32::INFINITY };
        // A half does not become more children than it has boxes.
        let (left, right) = (&left[..middle.min(WIDTH - 1)], &right[..(count - middle).min(WIDTH - 1)]);
        let (cuts, costs) = cuts([left, right], leaf, bounds.half_area());
        let Bounds { low, high } = bounds;
        *part = Part { low: low.into(), left: middle as u32, high: high.into(), cuts };
        (bounds, costs)
    }
}

/// The best cuts of a part and their costs, from the costs of its halves, of a leaf, and of looking into a node.
fn cuts([left, right]: [&[f32]; 2], leaf: f32, node: f32) -> ([Cut; WIDTH], Costs) {
    let (mut cuts, mut costs) = ([Cut::NONE; WIDTH], [f32::INFINITY; WIDTH]);
    for (a, left) in left.iter().enumerate() {
        for (b, right) in right[..right.len().min(WIDTH - 1 - a)].iter().enumerate() {
            let cost = left + right;
            if cost < costs[a + b + 1] {
                (cuts[a + b + 1], costs[a + b + 1]) = (Cut::new(a + 1, b + 1), cost);
            }
        }
    }
    // The fewest children that cost no more.
    for i in 2..WIDTH {
        if costs[i - 1] <= costs[i] {
            (cuts[i], costs[i]) = (cuts[i - 1], costs[i - 1]);
        }
    }
    let below = costs[WIDTH - 1] + node;
    (cuts[0], costs[0]) = if leaf <= below { (Cut::NONE, leaf) } else { (cuts[WIDTH - 1], below) };
    for i in 1..WIDTH {
        if costs[0] <= costs[i] {
            (cuts[i], costs[i]) = (Cut::NONE, costs[0]);
        }
    }
    (cuts, costs)
}

/// Bins along each axis, at most.
const BINS: usize = 16;

/// What falls into a bin.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Bounds,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Bounds::EMPTY, count: 0 };

    fn and(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), count: self.count + other.count }
    }

    /// In leaves: one that is not full costs no less.
    fn cost(self, capacity: usize) -> f32 {
        if self.count == 0 {
            return 0.0;
        }
        self.bounds.half_area() * self.count.div_ceil(capacity as u32) as f32
    }
}

/// By axis.
type Bins = [[Bin; BINS]; 3];

const NO_BINS: Bins = [[Bin::EMPTY; BINS]; 3];

/// The last bits of a number about as large are those of the integer that it was rounded to: several times as fast as a conversion.
const INTEGERS: f32 = (1 << 23) as f32;

/// How centres are sorted into bins.
struct Grid {
    low: Vec3A,
    scale: Vec3A,
    bins: usize,
}

impl Grid {
    fn new(items: &[Item]) -> Self {
        let centres = |items: &[Item]| Bounds::around(items.iter().map(|item| item.centre()));
        let Bounds { low, high } = if items.len() > PARALLEL {
            items.par_chunks(PARALLEL).map(centres).reduce(|| Bounds::EMPTY, Bounds::union)
        } else {
            centres(items)
        };
        let bins = BINS.min(8 + items.len() / 16);
        // Everything falls into the first bin where there is no extent.
        let extent = (high - low).max(Vec3A::splat(f32::MIN_POSITIVE));
        Self { low, scale: Vec3A::splat((bins - 1) as f32) / extent, bins }
    }

    /// By axis.
    #[inline]
    fn bin(&self, item: &Item) -> [usize; 3] {
        let place = (item.centre() - self.low) * self.scale + Vec3A::splat(INTEGERS);
        place.to_array().map(|place| place.to_bits() as usize % BINS)
    }

    /// The same along one axis.
    #[inline]
    fn bin_along(&self, axis: usize, item: &Item) -> usize {
        let centre = item.low.as_ref()[axis] + item.high.as_ref()[axis];
        let place = (centre - self.low.as_ref()[axis]) * self.scale.as_ref()[axis] + INTEGERS;
        place.to_bits() as usize % BINS
    }

    fn fill(&self, items: &[Item], bins: &mut Bins) {
        bins.iter_mut().for_each(|bins| bins[..self.bins].fill(Bin::EMPTY));
        for item in items {
            for (bins, place) in bins.iter_mut().zip(self.bin(item)) {
                let Bin { bounds, count } = bins[place];
                bins[place] = Bin { bounds: bounds.union(item.bounds()), count: count + 1 };
            }
        }
    }
}

/// Brings `items`, of which there are at least two, into an order so that it is best to part them before the one that is returned. Of items up to
/// `capacity` a leaf can be made.
fn split(items: &mut [Item], capacity: usize, bins: &mut Bins) -> usize {
    let middle = items.len() / 2;
    if items.len() <= FEW {
        sort_along_widest(items);
        return middle;
    }
    let grid = Grid::new(items);
    if items.len() > PARALLEL {
        let join = |a: Bins, b: Bins| {
            std::array::from_fn(|axis| std::array::from_fn(|i| a[axis][i].and(b[axis][i])))
        };
        let fill = |items: &[Item]| {
            let mut bins = NO_BINS;
            grid.fill(items, &mut bins);
            bins
        };
        *bins = items.par_chunks(PARALLEL).map(fill).reduce(|| NO_BINS, join);
    } else {
        grid.fill(items, bins);
    }
    let Some((axis, bin)) = best_plane(bins, grid.bins, capacity) else { return middle };
    let (mut left, mut right) = (0, items.len());
    while left < right {
        if grid.bin_along(axis, &items[left]) < bin {
            left += 1;
        } else {
            right -= 1;
            items.swap(left, right);
        }
    }
    left
}

/// So few items are cut in the middle: there are hardly other ways.
const FEW: usize = 4;

fn sort_along_widest(items: &mut [Item]) {
    let Bounds { low, high } = Bounds::around(items.iter().map(|item| item.centre()));
    let axis = (high - low).max_position();
    items.sort_unstable_by(|a, b| a.centre()[axis].total_cmp(&b.centre()[axis]));
}

/// The axis, and the first bin on the right; none if everything falls into one.
fn best_plane(bins: &Bins, count: usize, capacity: usize) -> Option<(usize, usize)> {
    let (mut least, mut best) = (f32::INFINITY, None);
    let all: u32 = bins[0][..count].iter().map(|bin| bin.count).sum();
    for (axis, bins) in bins.iter().enumerate() {
        let mut right = Bin::EMPTY;
        let mut right_costs = [0.0; BINS];
        for i in (1..count).rev() {
            right = right.and(bins[i]);
            right_costs[i] = right.cost(capacity);
        }
        let mut left = Bin::EMPTY;
        for i in 1..count {
            left = left.and(bins[i - 1]);
            let cost = left.cost(capacity) + right_costs[i];
            if left.count > 0 && left.count < all && cost < least {
                (least, best) = (cost, Some((axis, i)));
            }
        }
    }
    best
}
