/** The verdict as rows: one for each hard rule and each constraint of the knowledge base. */
import { type ConstraintResult, ConstraintStatus, type Report } from "../gen/d3dgen/v1/report_pb";
import { names } from "./names.svelte";
import { figure, t, unitSaid } from "./texts.svelte";
import { type Broken, ofViolation } from "./world";

export type Standing = "broken" | "advice" | "held" | "undecided" | "elsewhere";

/** A rule with everything it was held against. */
export interface RuleRow {
  id: string;
  title: string;
  standing: Standing;
  hard: boolean;
  mandatory: boolean;
  checked: number;
  broken: Broken[];
  results: ConstraintResult[];
}

const RANK: Record<Standing, number> = { broken: 0, advice: 1, held: 2, undecided: 3, elsewhere: 4 };

/** Unit of what is so or is not. */
const TRUTH = "boolean";

/** Returns what was measured, in words: `1.5 m`; nothing where nothing was. */
export function measuredIn(result: ConstraintResult): string {
  if (result.measured === undefined) return "";
  return result.unit === TRUTH ? t(result.measured ? "yes" : "no") : `${figure(result.measured)} ${unitSaid(result.unit)}`.trim();
}

/** Returns what a constraint requires, in words: `at least 1.2 m`; nothing of what is so or is not. */
export function required(result: ConstraintResult): string {
  return result.unit === TRUTH ? "" : wanted(result).trim();
}

function wanted({ unit: of, requiredMin: min, requiredMax: max }: ConstraintResult): string {
  const unit = unitSaid(of);
  if (min !== undefined && max !== undefined && min !== max) return `${figure(min)} – ${figure(max)} ${unit}`;
  if (min !== undefined && max === min) return `${figure(min)} ${unit}`;
  if (min !== undefined) return t("atLeast", { value: figure(min), unit });
  return max === undefined ? "" : t("atMost", { value: figure(max), unit });
}

export function ofConstraint(result: ConstraintResult): Broken {
  const measured = measuredIn(result);
  return {
    id: result.constraintId,
    subject: result.subject,
    message: t("measuredBut", { name: names.measure(result.name), measured, required: required(result) || t("yes") }),
    hard: result.mandatory,
    measured: result.measured,
    required: result.requiredMin ?? result.requiredMax,
    unit: result.unit,
  };
}

const violated = (r: ConstraintResult) => r.status === ConstraintStatus.VIOLATED;

/** Returns everything that is broken, hard rules first. */
export function brokenOf(report: Report | undefined): Broken[] {
  if (!report) return [];
  const hard = report.rules.flatMap((rule) => rule.violations.map((v) => ofViolation(v)));
  const constraints = report.constraints.filter(violated).map(ofConstraint);
  return [...hard, ...constraints.sort((a, b) => Number(b.hard) - Number(a.hard))];
}

/** Rules that a plan breaks only while a wall is dragged: the server joins walls anew when it is let go. */
const OF_DRAWING = new Set(["wall_gap", "wall_stray"]);

/** Returns the verdict on a world that is being dragged, without what is broken of its drawing alone. */
export function ofDragged(report: Report | undefined): Report | undefined {
  if (!report) return undefined;
  return { ...report, rules: report.rules.map((rule) => (OF_DRAWING.has(rule.rule) ? { ...rule, violations: [] } : rule)) };
}

function standing(results: ConstraintResult[]): Standing {
  const has = (status: ConstraintStatus) => results.some((r) => r.status === status);
  if (has(ConstraintStatus.VIOLATED)) return results.some((r) => violated(r) && r.mandatory) ? "broken" : "advice";
  if (has(ConstraintStatus.SATISFIED)) return "held";
  return has(ConstraintStatus.NOT_DECIDABLE) ? "undecided" : "elsewhere";
}

/** Returns all rules as rows, what is broken first; what only simulators depend on comes last where it is kept. */
export function rowsOf(report: Report | undefined): RuleRow[] {
  if (!report) return [];
  const byId = new Map<string, ConstraintResult[]>();
  for (const result of report.constraints) {
    byId.set(result.constraintId, [...(byId.get(result.constraintId) ?? []), result]);
  }
  const constraints = [...byId].map(([id, results]): RuleRow => ({
    id,
    title: names.measure(results[0].name),
    standing: standing(results),
    hard: false,
    mandatory: results.some((r) => r.mandatory),
    checked: results.length,
    broken: results.filter(violated).map(ofConstraint),
    results,
  }));
  const hard = report.rules.map((rule): RuleRow => ({
    id: rule.rule,
    title: names.rule(rule.rule, rule.title),
    standing: rule.violations.length > 0 ? "broken" : rule.checked > 0 ? "held" : "elsewhere",
    hard: true,
    mandatory: true,
    checked: rule.checked,
    broken: rule.violations.map((v) => ofViolation(v)),
    results: [],
  }));
  const kind = (row: RuleRow) => (row.hard ? (row.standing === "broken" ? 0 : 3) : row.mandatory ? 1 : 2);
  const weight = (row: RuleRow) => RANK[row.standing] * 4 + kind(row);
  return [...hard, ...constraints].sort((a, b) => weight(a) - weight(b));
}
