// Requests to the service, and errors in its words.

export class Refused extends Error {
  constructor(status, problem) {
    super(problem.where ? `${problem.where}: ${problem.what}` : problem.what);
    this.status = status;
    this.fix = problem.fix || "";
  }
}

export async function ask(method, path, body) {
  const options = { method, headers: {} };
  if (body !== undefined) {
    options.headers["content-type"] = "application/json";
    options.body = JSON.stringify(body);
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
  return text ? JSON.parse(text) : null;
}

export const get = (path) => ask("GET", path);
export const post = (path, body) => ask("POST", path, body);
