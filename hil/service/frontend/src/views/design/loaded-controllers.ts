// Controllers that a plan loads, by its text: each file once.

export const loadedBy = (text: string): string[] =>
  [...new Set([...text.matchAll(/set_controller:\s*\{?\s*file:\s*["']?([^"'}\s]+)/g)].map((match) => match[1] as string))];
