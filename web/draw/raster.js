// @ts-check
// Triangles and lines with a depth to each pixel, in an image of a canvas: the same picture with a graphics card and
// without one.

export class Raster {
  #width = 0;
  #height = 0;

  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    this.image = this.context.createImageData(1, 1);
    this.pixels = new Uint32Array(this.image.data.buffer);
    this.depth = new Float32Array(1);
  }

  /**
   * An empty image of so many pixels.
   *
   * @param {number} width
   * @param {number} height
   */
  clear(width, height) {
    if (width !== this.#width || height !== this.#height) {
      [this.#width, this.#height] = [width, height];
      [this.canvas.width, this.canvas.height] = [width, height];
      this.image = this.context.createImageData(width, height);
      this.pixels = new Uint32Array(this.image.data.buffer);
      this.depth = new Float32Array(width * height);
    }
    this.pixels.fill(0);
    this.depth.fill(-Infinity);
  }

  /** Puts what was drawn onto the canvas. */
  done() {
    this.context.putImageData(this.image, 0, 0);
  }

  /**
   * A triangle of one color; x and y in pixels, what has more z is nearer.
   *
   * @type {(ax: number, ay: number, az: number, bx: number, by: number, bz: number, cx: number, cy: number, cz: number,
   *   color: number) => void}
   */
  triangle(ax, ay, az, bx, by, bz, cx, cy, cz, color) {
    const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    if (area === 0) return;
    const dzdx = ((bz - az) * (cy - ay) - (cz - az) * (by - ay)) / area;
    const dzdy = ((cz - az) * (bx - ax) - (bz - az) * (cx - ax)) / area;
    const [width, height] = [this.#width, this.#height];
    const top = Math.max(0, Math.ceil(Math.min(ay, by, cy) - 0.5));
    const end = Math.min(height, Math.ceil(Math.max(ay, by, cy) - 0.5));
    const { pixels, depth } = this;
    for (let y = top; y < end; y += 1) {
      const level = y + 0.5;
      let left = Infinity;
      let right = -Infinity;
      // The row meets two of the edges.
      if (ay <= level !== by <= level) {
        const x = ax + ((level - ay) / (by - ay)) * (bx - ax);
        left = x;
        right = x;
      }
      if (by <= level !== cy <= level) {
        const x = bx + ((level - by) / (cy - by)) * (cx - bx);
        if (x < left) left = x;
        if (x > right) right = x;
      }
      if (cy <= level !== ay <= level) {
        const x = cx + ((level - cy) / (ay - cy)) * (ax - cx);
        if (x < left) left = x;
        if (x > right) right = x;
      }
      const from = Math.max(0, Math.ceil(left - 0.5));
      const to = Math.min(width, Math.ceil(right - 0.5));
      let z = az + (from + 0.5 - ax) * dzdx + (level - ay) * dzdy;
      for (let i = y * width + from, last = y * width + to; i < last; i += 1, z += dzdx) {
        if (z > depth[i]) {
          depth[i] = z;
          pixels[i] = color;
        }
      }
    }
  }

  /**
   * A line so many pixels wide, seen where nothing is nearer by more than `lift`.
   *
   * @type {(ax: number, ay: number, az: number, bx: number, by: number, bz: number, wide: number, lift: number, color:
   *   number) => void}
   */
  line(ax, ay, az, bx, by, bz, wide, lift, color) {
    const steps = Math.max(1, Math.ceil(Math.max(Math.abs(bx - ax), Math.abs(by - ay))));
    if (steps > 20_000) return;
    const [width, height, r] = [this.#width, this.#height, wide / 2];
    for (let k = 0; k <= steps; k += 1) {
      const t = k / steps;
      const [x, y, z] = [ax + t * (bx - ax), ay + t * (by - ay), az + t * (bz - az) + lift];
      for (
        let row = Math.max(0, Math.round(y - r)),
          last = Math.min(height - 1, Math.max(Math.round(y - r), Math.round(y + r) - 1));
        row <= last;
        row += 1
      ) {
        for (
          let i = Math.max(0, Math.round(x - r)),
            stop = Math.min(width - 1, Math.max(Math.round(x - r), Math.round(x + r) - 1));
          i <= stop;
          i += 1
        ) {
          const place = row * width + i;
          if (z >= this.depth[place]) {
            this.depth[place] = z;
            this.pixels[place] = color;
          }
        }
      }
    }
  }
}

/**
 * A color of three numbers up to 255 as a pixel has it.
 *
 * @type {(color: number[]) => number}
 */
export const pixelOf = ([r, g, b]) => ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;
