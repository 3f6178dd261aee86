// Numbers of runs as an address names them.

export const runsFrom = (text: string | null): number[] =>
  [...new Set((text ?? "").split(",").map(Number))].filter((one) => Number.isInteger(one) && one > 0).slice(0, 20);
