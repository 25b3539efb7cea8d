// Follow: when the map is read again. Thousands of events in a burst are one reading: once they pause, or at the latest after a while.

const PAUSE_MS = 400;
const LATEST_MS = 5000;
/** A map that takes long to read is read less often: so many times as long passes between two readings. */
const REST = 3;

/** Reads a map again, one reading at a time, when something in it has changed. */
export class Follower {
  /** `version()` is what has been read, `isReading()` whether a reading is under way, and `read()` begins one. */
  constructor({ version, isReading, read }) {
    Object.assign(this, { version, isReading, read, tookMs: 0 });
    this.stop();
  }

  /** Forgets what it was told, as for another map. */
  stop() {
    clearTimeout(this.timer);
    Object.assign(this, { timer: null, first: null, wanted: 0, must: false, ended: -Infinity });
  }

  /** The map has this version now, or a newer one. */
  told(version) {
    if (version <= this.version()) return;
    this.wanted = Math.max(this.wanted, version);
    this.plan();
  }

  /** Something has changed that the version does not tell. */
  soon() {
    this.must = true;
    this.plan();
  }

  /** A reading is over, whoever began it. */
  ranFor(milliseconds) {
    this.tookMs = milliseconds;
    this.ended = performance.now();
  }

  plan() {
    const now = performance.now();
    this.first ??= now;
    const due = Math.max(Math.min(now + PAUSE_MS, this.first + LATEST_MS), this.ended + REST * this.tookMs);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.run(), Math.max(due - now, 0));
  }

  run() {
    // What is being read may lack the news.
    if (this.isReading()) {
      this.timer = setTimeout(() => this.run(), PAUSE_MS);
      return;
    }
    this.first = null;
    const isNews = this.must || this.wanted > this.version();
    this.must = false;
    if (isNews) this.read();
  }
}
