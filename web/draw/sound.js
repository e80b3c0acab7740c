// @ts-check
// Orders as tones, by the browser's own audio: nothing sounds until it is asked for.

/** All tones together at their loudest. */
const LOUDEST = 0.25;
/** A change of pitch or loudness takes so long, in seconds. */
const GLIDE = 0.03;
const [LOWEST, HIGHEST] = [20, 18_000];

export class Tones {
  #context = null;
  #master = null;
  #voices = [];

  get on() {
    return this.#context !== null;
  }

  start() {
    this.#context = new AudioContext();
    this.#master = new GainNode(this.#context, { gain: LOUDEST });
    this.#master.connect(this.#context.destination);
  }

  stop() {
    this.#context?.close();
    this.#context = null;
    this.#voices = [];
  }

  /** Sounds `tones`, each `{ hz, part }` of all that is loudest. What no ear hears is silent. */
  play(tones) {
    if (!this.#context) return;
    const now = this.#context.currentTime;
    while (this.#voices.length < tones.length) this.#voices.push(this.#voice());
    this.#voices.forEach(({ oscillator, gain }, i) => {
      const { hz = 0, part = 0 } = tones[i] ?? {};
      const heard = hz >= LOWEST && hz <= HIGHEST;
      if (heard) oscillator.frequency.setTargetAtTime(hz, now, GLIDE);
      gain.gain.setTargetAtTime(heard ? part : 0, now, GLIDE);
    });
  }

  #voice() {
    const oscillator = new OscillatorNode(this.#context, { frequency: LOWEST });
    const gain = new GainNode(this.#context, { gain: 0 });
    oscillator.connect(gain).connect(this.#master);
    oscillator.start();
    return { oscillator, gain };
  }
}
