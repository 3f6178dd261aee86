// A plan in few words: how it is listed, how long it takes, how much torque it asks for.

import type { Plan } from "../../api/types.ts";
import { duration, figure } from "../../format.ts";
import { t } from "../../i18n/text.ts";

// Titles of copies are alike: the name comes first.
export const listed = ({ name, title }: Pick<Plan, "name" | "title">): string => (title ? `${name}: ${title}` : name);

export const durationOf = (plan: Plan): string => (plan.duration_s == null ? "–" : duration(plan.duration_s));

const TORQUES: Record<string, (value: string) => string> = {
  driving_torque: (value) => t("{value} at the wheels", { value }),
  motor_torque: (value) => t("{value} at the motor", { value }),
};

export const torquesOf = (plan: Plan): string =>
  Object.entries(plan.largest_requests_nm ?? {}).map(([quantity, value]) => TORQUES[quantity]?.(figure(value, "N m")) ?? figure(value, "N m")).join(", ") || "–";
