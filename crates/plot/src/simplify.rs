//! Fewer points for the same picture.

/// The points of `path` that are needed so that no other lies farther than `tolerance` from what is drawn
/// (Ramer, Douglas and Peucker); the first and the last stay.
pub(crate) fn simplified(path: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    if path.len() < 3 {
        return path.to_vec();
    }
    let mut kept = vec![false; path.len()];
    kept[0] = true;
    kept[path.len() - 1] = true;
    let mut open = vec![(0, path.len() - 1)];
    while let Some((first, last)) = open.pop() {
        let farthest = (first + 1..last)
            .map(|i| (i, distance(path[i], path[first], path[last])))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((middle, distance)) = farthest.filter(|&(_, distance)| distance > tolerance) {
            debug_assert!(distance.is_finite(), "only numbers are drawn");
            kept[middle] = true;
            open.push((first, middle));
            open.push((middle, last));
        }
    }
    path.iter()
        .zip(kept)
        .filter_map(|(&point, kept)| kept.then_some(point))
        .collect()
}

/// The distance of `p` from the segment `a` to `b`.
fn distance(p: (f64, f64), a: (f64, f64), b: (f64, f64)) -> f64 {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (px, py) = (p.0 - a.0, p.1 - a.1);
    let length_squared = dx * dx + dy * dy;
    let t = if length_squared > 0.0 {
        ((px * dx + py * dy) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (px - t * dx).hypot(py - t * dy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_run_keeps_its_ends_and_a_corner_stays() {
        let path: Vec<(f64, f64)> = (0_i32..=20)
            .map(|i| (f64::from(i), f64::from((i - 10).abs())))
            .collect();
        assert_eq!(
            simplified(&path, 0.1),
            [(0.0, 10.0), (10.0, 0.0), (20.0, 10.0)]
        );
    }

    #[test]
    fn no_point_is_farther_from_what_is_drawn_than_the_tolerance() {
        let path: Vec<(f64, f64)> = (0..400)
            .map(|i| (f64::from(i) / 10.0, 20.0 * (f64::from(i) / 30.0).sin()))
            .collect();
        let drawn = simplified(&path, 0.2);
        assert!(drawn.len() < path.len() / 3, "{} points", drawn.len());
        for p in path {
            let nearest = drawn
                .windows(2)
                .map(|s| distance(p, s[0], s[1]))
                .fold(f64::INFINITY, f64::min);
            assert!(nearest <= 0.2);
        }
    }
}
