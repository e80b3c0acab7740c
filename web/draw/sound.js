// @ts-check
// Orders as tones, by the browser's own audio: nothing sounds until it is asked for.

/** All tones together at their loudest. */
const LOUDEST = 0.25;
/** A change of pitch or loudness takes so long, in seconds. */
const GLIDE = 0.03;
const [LOWEST, HIGHEST] = [20, 18_000];

export class Tones {
  /** @type {AudioContext | null} */
  #context = null;
  /** @type {GainNode | null} */
  #master = null;
  /** @type {{ oscillator: OscillatorNode, gain: GainNode }[]} */
  #voices = [];

  get on() {
    return this.#context !== null;
  }

  start() {
    const context = new AudioContext();
    this.#context = context;
    this.#master = new GainNode(context, { gain: LOUDEST });
    this.#master.connect(context.destination);
  }

  stop() {
    this.#context?.close();
    this.#context = null;
    this.#voices = [];
  }

  /**
   * Sounds `tones`, each `{ hz, part }` of all that is loudest. What no ear hears is silent.
   *
   * @param {{ hz: number, part: number }[]} tones
   */
  play(tones) {
    if (!this.#context || !this.#master) return;
    const now = this.#context.currentTime;
    while (this.#voices.length < tones.length) this.#voices.push(this.#voice(this.#context, this.#master));
    this.#voices.forEach(({ oscillator, gain }, i) => {
      const { hz = 0, part = 0 } = tones[i] ?? {};
      const heard = hz >= LOWEST && hz <= HIGHEST;
      if (heard) oscillator.frequency.setTargetAtTime(hz, now, GLIDE);
      gain.gain.setTargetAtTime(heard ? part : 0, now, GLIDE);
    });
  }

  /**
   * @param {AudioContext} context
   * @param {AudioNode} master
   */
  #voice(context, master) {
    const oscillator = new OscillatorNode(context, { frequency: LOWEST });
    const gain = new GainNode(context, { gain: 0 });
    oscillator.connect(gain).connect(master);
    oscillator.start();
    return { oscillator, gain };
  }
}
