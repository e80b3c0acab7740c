//! A curve in a terminal.

/// Draws `values` over `x` from 0 to `span` as `width` by `height` characters with its scales.
///
/// Each column shows the range of the values that fall into it, so that no peak is lost.
pub(crate) fn line_chart(
    values: &[f64],
    span: f64,
    x_label: &str,
    width: usize,
    height: usize,
) -> String {
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| {
            (low.min(v), high.max(v))
        });
    if values.is_empty() || width == 0 || height < 2 || !(low.is_finite() && high.is_finite()) {
        return String::new();
    }
    let step = (high - low).max(f64::MIN_POSITIVE) / (height - 1) as f64;
    let row_of = |value: f64| (((high - value) / step).round() as usize).min(height - 1);
    let mut canvas = vec![vec![' '; width]; height];
    for column in 0..width {
        let from = column * values.len() / width;
        let to = ((column + 1) * values.len() / width)
            .max(from + 1)
            .min(values.len());
        // The value before belongs to the column too, so that the line does not break.
        let rows = values[from.saturating_sub(1)..to]
            .iter()
            .map(|&value| row_of(value));
        let (top, bottom) = rows.fold((height, 0), |(top, bottom), row| {
            (top.min(row), bottom.max(row))
        });
        for line in canvas.iter_mut().take(bottom + 1).skip(top) {
            line[column] = '*';
        }
    }
    let mut text = String::new();
    for (row, line) in canvas.iter().enumerate() {
        let scale = if row % 4 == 0 || row + 1 == height {
            format!("{:8.2}", high - step * row as f64)
        } else {
            " ".repeat(8)
        };
        text.push_str(&format!(
            "{scale} |{}\n",
            line.iter().collect::<String>().trim_end()
        ));
    }
    let end = format!("{span} {x_label}");
    text.push_str(&format!(
        "{:8} +{}\n{:8}  0{end:>rest$}\n",
        "",
        "-".repeat(width),
        "",
        rest = width - 1
    ));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_touch_the_first_row_and_valleys_the_last() {
        let values: Vec<f64> = (0..100).map(|i| f64::from(i % 50)).collect();
        let chart = line_chart(&values, 2.0, "mesh periods", 40, 9);
        let lines: Vec<&str> = chart.lines().collect();
        assert_eq!(lines.len(), 11);
        assert!(lines[0].starts_with("   49.00 |") && lines[0].contains('*'));
        assert!(lines[8].starts_with("    0.00 |*"));
        assert!(lines[10].ends_with("2 mesh periods"));
    }

    #[test]
    fn nothing_is_drawn_of_nothing() {
        assert_eq!(line_chart(&[], 1.0, "", 10, 5), "");
        assert_eq!(line_chart(&[f64::NAN], 1.0, "", 10, 5), "");
    }
}
