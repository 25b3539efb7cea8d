// Reader: reads a map, and reads it again when it has changed or the server is back.

import { everything, get, key, list, path } from "./viewer_api.js";
import { keyWanted, noKeyframes, noMaps, noSuchMap, unreachable } from "./viewer_empty.js";
import { listen } from "./viewer_events.js";
import { Follower } from "./viewer_follow.js";

const LOOK_AGAIN_MS = 4000;
const SELDOM = 8;

/** Reads one map at a time. */
export class Reader {
  /**
   * `on.maps(maps)` hears which maps there are, `on.open(map, meta)` that one is to be opened, `on.read(all)` what it holds,
   * `on.event(event)` what happens in it, `on.cover(content)` what to show instead of it (null: nothing), and `on.connected(how)` how
   * the server is reached. `on.isTyping()` tells whether somebody is entering a key, and `on.start()` begins once more.
   */
  constructor(on) {
    Object.assign(this, { on, map: null, meta: null, version: 0, stream: null, loading: null, looks: 0, isLive: false });
    this.follower = new Follower({ version: () => this.version, isReading: () => this.loading !== null, read: () => this.load() });
    setInterval(() => this.lookAgain(), LOOK_AGAIN_MS);
    document.addEventListener("visibilitychange", () => this.lookAgain());
  }

  /** Begins with a map, or with the first that there is. */
  async start(map) {
    this.map = map;
    try {
      const maps = await this.readMaps();
      if (map !== null) await this.on.open(map, maps.find(({ id }) => id === map));
    } catch (error) {
      this.failed(error);
    }
  }

  /** Leaves the map that was read. */
  leave(map) {
    this.stream?.stop();
    this.loading?.abort();
    this.follower.stop();
    Object.assign(this, { map, meta: null, version: 0, stream: null, loading: null });
  }

  /** Reads a map and listens to it; false if that failed or another map was opened meanwhile. */
  async open(meta = null) {
    if (!await this.load(meta)) return false;
    this.stream = listen(this.map, { event: (event) => this.told(event), state: (how) => this.connected(how) });
    return true;
  }

  /** Something has changed that the version does not tell. */
  soon() {
    this.follower.soon();
  }

  /** Reads the map again, but for what `meta` says. */
  async load(meta = null) {
    this.loading?.abort();
    const turn = new AbortController();
    this.loading = turn;
    const begun = performance.now();
    try {
      const all = await everything(this.map, turn.signal, meta);
      if (turn.signal.aborted) return false;
      Object.assign(this, { meta: all.meta, version: all.version });
      this.on.cover(all.keyframes.length + all.anchors.length === 0 ? noKeyframes(this.map) : null);
      this.on.read(all);
      return true;
    } catch (error) {
      if (!turn.signal.aborted) this.failed(error);
      return false;
    } finally {
      if (this.loading === turn) {
        this.follower.ranFor(performance.now() - begun);
        this.loading = null;
      }
    }
  }

  /** An event: history is only listed, news also refresh the map. */
  told(event) {
    this.on.event(event);
    this.follower.told(event.map_version);
  }

  connected(how) {
    this.isLive = how === "live";
    this.on.connected(how);
  }

  failed(error) {
    const { cover, start } = this.on;
    if (error.status === 401) cover(keyWanted(start, key() && error.message));
    // A key without `read` cannot show anything: another one may.
    else if (error.status === 403 && this.meta === null) cover(keyWanted(start, error.message));
    else if (error.status === 404 && this.map !== null) this.gone();
    // What was read before stays on the page while the server is away.
    else if (this.meta === null) cover(unreachable(error.message));
    this.connected(error.status < 500 ? "reached" : "away");
  }

  /** The map is not there (any more); it may come. */
  gone() {
    this.stream?.stop();
    Object.assign(this, { stream: null, meta: null });
    this.on.cover(noSuchMap(this.map));
  }

  /** Maps come and go, and settings change without an event: look now and then; often only while no events come. */
  async lookAgain() {
    // Whoever types a key is not disturbed; an old one would be refused again and again.
    if (document.hidden || this.loading !== null || this.on.isTyping()) return;
    this.looks += 1;
    const isTime = this.looks % SELDOM === 0;
    if (this.isLive && !isTime) return;
    try {
      if (this.map === null || isTime) await this.readMaps();
      if (this.map === null) return;
      const meta = await get(path("maps", this.map));
      if (meta.id !== this.map) return;
      if (this.stream === null || this.meta === null) await this.on.open(this.map);
      else this.follower.told(meta.map_version);
    } catch (error) {
      this.failed(error);
    }
  }

  /** Reads the list of maps, and gives it. */
  async readMaps() {
    const { items } = await list("v1/maps");
    this.on.maps(items.map(({ id }) => id));
    if (this.map === null && items.length > 0) await this.on.open(items[0].id, items[0]);
    else if (this.map === null) {
      const { covered } = await get("v1/maps?limit=1");
      this.on.cover(noMaps(covered));
      this.connected("reached");
    }
    return items;
  }
}
