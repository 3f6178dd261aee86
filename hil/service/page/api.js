// Requests to the service, and errors in its words.

export class Refused extends Error {
  constructor(status, problem) {
    super(problem.where ? `${problem.where}: ${problem.what}` : problem.what);
    this.status = status;
    this.fix = problem.fix || "";
  }
}

// body: an object is sent as JSON, a text as a file; asText: the answer is a file
export async function ask(method, path, body, asText = false) {
  const options = { method, headers: {} };
  if (body !== undefined) {
    const isFile = typeof body === "string";
    options.headers["content-type"] = isFile ? "text/plain" : "application/json";
    options.body = isFile ? body : JSON.stringify(body);
  }
  let answer;
  try {
    answer = await fetch(`/api/v1${path}`, options);
  } catch {
    throw new Refused(0, { what: "the service does not answer" });
  }
  const text = await answer.text();
  if (!answer.ok) {
    let problem = { what: `status ${answer.status}` };
    try { problem = JSON.parse(text); } catch { /* a proxy's answer */ }
    throw new Refused(answer.status, problem);
  }
  if (asText) return text;
  return text ? JSON.parse(text) : null;
}

const STOP_MS = 30000, AGAIN_MS = 50;
let stopUrl = "";

// Where the service takes emergency stops whatever else it does: asked beforehand, for a flooded service answers late.
export async function findStopPost() {
  stopUrl = (await get("/health")).stop_url;
}

// Both ways at the same moment; the first that has taken it is enough. A flooded service closes connections: a way
// on which no one answers is tried again.
export async function stopNow(path) {
  const untilMs = Date.now() + STOP_MS;
  const insist = async (way) => {
    for (;;) {
      try { return await way(); } catch (error) {
        if ((error instanceof Refused && error.status) || Date.now() > untilMs) throw error;
        await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
      }
    }
  };
  const ways = [insist(() => post(path))];
  if (stopUrl) ways.push(insist(async () => {
    const answer = await fetch(`${stopUrl}/api/v1${path}`, { method: "POST", credentials: "include" });
    if (!answer.ok) throw new Refused(answer.status, { what: `status ${answer.status}` });
  }));
  try { await Promise.any(ways); } catch (error) { throw error.errors[0]; }
}

export const get = (path) => ask("GET", path);
export const post = (path, body) => ask("POST", path, body);
