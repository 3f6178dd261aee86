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

export const get = (path) => ask("GET", path);
export const post = (path, body) => ask("POST", path, body);
