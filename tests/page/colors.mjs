// Colors as eyes see them.

/** Colors as an eye without green cones sees them (Machado 2009), in a space where distances are seen. */
export function seenByDeuteranopia(color) {
  const linear = color.map((value) =>
    value / 255 <= 0.04045 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4,
  );
  const seen = [
    [0.367322, 0.860646, -0.227968],
    [0.280085, 0.672501, 0.047413],
    [-0.01182, 0.04294, 0.968881],
  ].map((row) =>
    Math.min(
      1,
      Math.max(
        0,
        row.reduce((sum, part, i) => sum + part * linear[i], 0),
      ),
    ),
  );
  const f = (t) => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116);
  const [x, y, z] = [
    [0.4124, 0.3576, 0.1805, 0.95047],
    [0.2126, 0.7152, 0.0722, 1],
    [0.0193, 0.1192, 0.9505, 1.08883],
  ].map(([a, b, c, white]) => f((a * seen[0] + b * seen[1] + c * seen[2]) / white));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}
