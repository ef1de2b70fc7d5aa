// Requests to the workspace's server, and what it tells without being asked.

export class Refused extends Error {
  constructor(message, status, version) {
    super(message);
    Object.assign(this, { status, version });
  }
}

export async function ask(name, content = {}) {
  let response;
  try {
    response = await fetch(`/api/${name}`, { method: "POST", body: JSON.stringify(content), headers: { "Content-Type": "application/json" } });
  } catch {
    throw new Refused("The workspace has ended: start it again in the terminal with seatrial open.", 0);
  }
  const answer = response.headers.get("content-type")?.startsWith("application/json") ? await response.json() : { error: await response.text() };
  if (!response.ok) throw new Refused(answer.error || response.statusText, response.status, answer.version);
  return answer;
}

export async function upload(file) {
  const response = await fetch(`/api/upload/${encodeURIComponent(file.name)}`, { method: "POST", body: file });
  const answer = await response.json().catch(() => ({ error: response.statusText }));
  if (!response.ok) throw new Refused(answer.error, response.status);
  return answer.name;
}

export function listen(handlers) {
  const source = new EventSource("/api/events");
  for (const [kind, handle] of Object.entries(handlers)) source.addEventListener(kind, event => handle(JSON.parse(event.data)));
  source.addEventListener("error", () => handlers.gone?.(source.readyState === EventSource.CLOSED));
  return source;
}

// the newest of requests that come faster than they are answered
export function latest(work) {
  let waiting = null, isBusy = false;
  return async function request(...values) {
    waiting = values;
    if (isBusy) return;
    isBusy = true;
    while (waiting) {
      const present = waiting;
      waiting = null;
      await work(...present);
    }
    isBusy = false;
  };
}
