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

// Of a plan with its own values, or of a forecast with those that were chosen; '' where none is known.
export const torquesOf = (of: Pick<Plan, "largest_requests_nm"> | null): string =>
  Object.entries(of?.largest_requests_nm ?? {}).map(([quantity, value]) => TORQUES[quantity]?.(figure(value, "N m")) ?? figure(value, "N m")).join(", ");
