//! Bodies that touch: whose boundaries may lie in the same place.
//!
//! A path that goes through a surface is moved off it by more than rounding, and steps over whatever else lies there. Where one body begins
//! where another ends, both boundaries are one event ([`super::path`]); here is which bodies that can happen to.

use glam::Vec3;

/// More than the rounding of a position in the box from `low` to `high`, m.
pub fn margin(low: Vec3, high: Vec3) -> f32 {
    const ROUNDINGS: f32 = 8.0;
    ROUNDINGS * f32::EPSILON * low.abs().max(high.abs()).max_element()
}

/// By instance: the other `bodies` whose boxes meet its own, to rounding, where paths walk in at least one of the two. `bounds` are the
/// boxes of all instances; `bodies` are those that paths enter, `is_walked` those that they walk in.
pub fn neighbours(
    bodies: &[u32],
    is_walked: impl Fn(u32) -> bool,
    bounds: &[(Vec3, Vec3)],
) -> Vec<Box<[u32]>> {
    let grown = |body: u32| {
        let (low, high) = bounds[body as usize];
        let margin = margin(low, high);
        (low - margin, high + margin)
    };
    let mut sorted: Vec<(u32, (Vec3, Vec3))> = bodies.iter().map(|&body| (body, grown(body))).collect();
    sorted.sort_by(|(_, a), (_, b)| a.0.x.total_cmp(&b.0.x));
    let mut near = vec![Vec::new(); bounds.len()];
    for (index, &(body, (low, high))) in sorted.iter().enumerate() {
        // Those that begin farther along x than this one ends, and all after them, are apart.
        let beside = sorted[index + 1..].iter().take_while(|(_, other)| other.0.x <= high.x);
        let meeting = beside.filter(|(_, other)| other.0.cmple(high).all() && other.1.cmpge(low).all());
        for &(other, _) in meeting.filter(|&&(other, _)| is_walked(body) || is_walked(other)) {
            near[body as usize].push(other);
            near[other as usize].push(body);
        }
    }
    near.into_iter().map(Vec::into_boxed_slice).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_that_meet_are_neighbours_if_paths_walk_in_one() {
        let cube = |x: f32| (Vec3::new(x, 7.0, 0.0), Vec3::new(x + 1.0, 8.0, 1.0));
        let gap = cube(3.0 + 1e-3);
        let inner = (Vec3::new(0.2, 7.2, 0.2), Vec3::new(0.4, 7.4, 0.4));
        // Two that touch up to an ulp, one a little apart, one in the first, one that is no body.
        let bounds = [cube(1.0_f32.next_up()), cube(0.0), gap, inner, cube(0.0), cube(2.0)];
        let all = neighbours(&[0, 1, 2, 3, 5], |_| true, &bounds);
        let sorted = |i: usize| {
            let mut near = all[i].to_vec();
            near.sort_unstable();
            near
        };
        assert_eq!(
            [0, 1, 2, 3, 4, 5].map(sorted),
            [vec![1, 5], vec![0, 3], vec![], vec![1], vec![], vec![0]]
        );
        let one = neighbours(&[0, 1, 2, 3, 5], |body| body == 3, &bounds);
        assert_eq!((one[0].len(), &*one[1], &*one[3]), (0, &[3][..], &[1][..]));
    }
}
