/** Changes of the building rules: shown before they are written, listed, taken back. */
import { clone, create } from "@bufbuild/protobuf";

import type { Constraint } from "../gen/d3dgen/v1/knowledge_base_pb";
import { ConstraintSchema } from "../gen/d3dgen/v1/knowledge_base_pb";
import { type AmendKnowledgeRequest, type KnowledgeChange, type KnowledgeEdit } from "../gen/d3dgen/v1/knowledge_service_pb";
import type { ConstraintResult } from "../gen/d3dgen/v1/report_pb";
import { type ConstraintValue, ConstraintValueSchema } from "../gen/d3dgen/v1/values_pb";
import { knowledge } from "./api";
import { session } from "./session.svelte";
import { figure, t, unitSaid, words } from "./texts.svelte";

export type RuleChange = AmendKnowledgeRequest["change"];

/** A figure of a rule that a person can put otherwise: one number, or least and largest. */
export type Figure = { min: number; max?: number };

class Amendments {
  /** Changes of the rules of the domain at hand, newest first. */
  history = $state.raw<KnowledgeChange[]>([]);

  async load(domainId: string) {
    this.history = (await knowledge.listKnowledgeChanges({ domainId })).changes;
  }

  /** Returns what a change would be, and writes nothing. */
  async preview(domainId: string, change: RuleChange): Promise<KnowledgeEdit[]> {
    return (await knowledge.amendKnowledge({ domainId, change, validateOnly: true })).edits;
  }

  /** Writes a change, and has the world judged by the rules as they are then. */
  async write(domainId: string, change: RuleChange, why: string) {
    await knowledge.amendKnowledge({ domainId, change, why });
    await this.#changed(domainId);
  }

  async undo(change: KnowledgeChange) {
    await knowledge.undoKnowledgeChange({ seq: change.seq });
    await this.#changed(change.domainId);
  }

  async #changed(domainId: string) {
    await Promise.all([this.load(domainId), session.rejudge()]);
  }
}

export const amendments = new Amendments();

/** Returns the figure of a rule, where it is one that can be put as numbers. */
export function figureOf(value: ConstraintValue | undefined): Figure | undefined {
  const kind = value?.kind;
  if (kind?.case === "number") return { min: kind.value };
  return kind?.case === "range" ? { min: kind.value.min, max: kind.value.max } : undefined;
}

/** Returns the change that gives a rule another figure. */
export function withFigure(rule: Constraint, { min, max }: Figure): RuleChange {
  const constraint = clone(ConstraintSchema, rule);
  const kind = max === undefined ? { case: "number", value: min } : { case: "range", value: { min, max } };
  constraint.value = create(ConstraintValueSchema, { kind: kind as never });
  return { case: "update", value: { constraint, updateMask: { paths: ["value"] } } as never };
}

/** Returns how many of the places that a rule was held against would keep another figure, and how many not. */
export function effectOf(results: ConstraintResult[], { min, max }: Figure): { kept: number; broken: number } {
  let [kept, broken] = [0, 0];
  for (const { measured, requiredMin, requiredMax } of results) {
    if (measured === undefined) continue;
    const low = requiredMin === undefined ? -Infinity : min;
    const high = requiredMax === undefined ? Infinity : (max ?? min);
    if (measured >= low - 1e-6 && measured <= high + 1e-6) kept++;
    else broken++;
  }
  return { kept, broken };
}

function valueSaid(value: ConstraintValue | undefined, unit: string): string {
  const kind = value?.kind;
  switch (kind?.case) {
    case "number":
      return `${figure(kind.value)} ${unitSaid(unit)}`;
    case "range":
      return `${figure(kind.value.min)} – ${figure(kind.value.max)} ${unitSaid(unit)}`;
    case "flag":
      return t(kind.value ? "yes" : "no");
    case "expression":
    case "text":
      return kind.value;
    case "wholeNumber":
      return String(kind.value);
    case "list":
      return kind.value.items.map((item) => valueSaid(item, unit)).join(", ");
    case "table":
      return Object.entries(kind.value.entries).map(([name, entry]) => `${words(name)}: ${valueSaid(entry, unit)}`).join(", ");
    default:
      return "–";
  }
}

/** A line of a preview: what is changed, as it was, as it is to be. */
export interface EditLine {
  id: string;
  name: string;
  before: string;
  after: string;
}

/** Returns the edits of rules as lines; documents that come with a rule are left out. */
export function linesOf(edits: KnowledgeEdit[]): EditLine[] {
  return edits.flatMap(({ targetId, before, after }): EditLine[] => {
    const [was, is] = [before, after].map((entry) => (entry?.kind.case === "constraint" ? entry.kind.value.constraint : undefined));
    const rule = is ?? was;
    if (!rule) return [];
    const said = (one: Constraint | undefined) => (one ? `${words(one.constraintType)} ${valueSaid(one.value, one.unit)}` : "–");
    return [{ id: targetId, name: `${words(rule.name)} (${words(rule.spaceType)})`, before: said(was), after: said(is) }];
  });
}
