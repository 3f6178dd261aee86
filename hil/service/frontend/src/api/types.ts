// The API's types, by the names the page uses; schema.d.ts is made of docs/reference/openapi.json by the build.

import type { components } from "./schema.d.ts";

type Schemas = components["schemas"];

export type Bench = Schemas["BenchData"];
export type Run = Schemas["RunData"];
export type Plan = Schemas["PlanData"];
export type Forecast = Schemas["ForecastData"];
export type Me = Schemas["Me"];
export type Health = Schemas["Health"];
export type Problem = Schemas["Problem"];

export const ROLES = ["viewer", "operator", "engineer", "admin"] as const;
export type Role = (typeof ROLES)[number];
