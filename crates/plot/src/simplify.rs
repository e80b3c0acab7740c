//! Fewer points for the same picture.

/// Points that are looked at together. A path that goes to and fro is divided as often as it has points, and each division looks at all points between two.
const PIECE: usize = 200;

/// The points of `path` that are needed so that no other lies farther than `tolerance` from the drawn line (Ramer, Douglas and Peucker, piece by piece); the
/// first and the last stay.
pub(crate) fn simplified(path: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    if path.len() < 3 {
        return path.to_vec();
    }
    let end = path.len() - 1;
    let mut kept = vec![false; path.len()];
    kept[end] = true;
    let mut open = Vec::new();
    for first in (0..end).step_by(PIECE) {
        kept[first] = true;
        open.push((first, end.min(first + PIECE)));
    }
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
    fn a_path_of_200_000_points_is_drawn_in_a_time_that_grows_as_its_points() {
        // To and fro, ever farther: each division takes one point off. Looked at as a whole this takes minutes.
        let path: Vec<(f64, f64)> = (0..200_000_i32)
            .map(|i| (f64::from(i), f64::from(i % 2) * 1e-2 * f64::from(i)))
            .collect();
        let drawn = simplified(&path, 0.1);
        assert!(drawn.len() > 190_000, "{} points", drawn.len());
        // Straight parts lose all points but an end for each piece.
        let straight: Vec<(f64, f64)> = (0..200_001_i32).map(|i| (f64::from(i), 0.0)).collect();
        assert_eq!(simplified(&straight, 0.1).len(), 200_000 / PIECE + 1);
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
