// Turns: a key may be allowed few requests a second. What was refused for that waits as long as the server says, one after the other.

const TRIES = 10;
const BUSY = 429;

let queue = Promise.resolve();

/** Fetches, and fetches again where the key had asked too often. New requests wait behind those that were refused. */
export async function fetchInTurn(address, options) {
  let turn = queue;
  for (let tries = 1; ; tries += 1) {
    await turn;
    const response = await fetch(address, options);
    if (response.status !== BUSY || tries === TRIES) return response;
    const seconds = Number(response.headers.get("retry-after")) || 1;
    // Nobody waits for a request that was given up.
    turn = queue = queue.then(() => (options?.signal?.aborted ? null : new Promise((resume) => { setTimeout(resume, seconds * 1000); })));
  }
}
