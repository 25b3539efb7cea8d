// Schema: the fields of a body or an answer, each with its type, its bounds and its meaning.

import { el, number } from "./dom.js";
import { inline, prose } from "./docs_prose.js";

/** The schemas of one API document. */
export class Schemas {
  constructor(api) {
    this.named = api.components?.schemas ?? {};
  }

  /** What a `$ref` stands for, and its name; a description beside it wins. */
  resolve(schema) {
    if (!schema?.$ref) return { schema: schema ?? {}, name: null };
    const name = schema.$ref.split("/").at(-1);
    const { $ref, ...beside } = schema;
    return { schema: { ...this.named[name], ...beside }, name };
  }

  /** All fields of a schema, nested ones folded. */
  fields(given) {
    const { schema, name } = this.resolve(given);
    const about = schema.description && prose(schema.description);
    const { inner, each } = this.inside(given);
    if (inner) {
      return el("div", { class: "schema" }, each && el("p", {}, this.type(given)), about, this.members(inner, name ? [name] : []));
    }
    return el("div", { class: "schema" }, el("p", {}, this.type(given), bounds(schema)), about);
  }

  /** The object that a schema holds: itself, or the items of its list. */
  inside(given) {
    let { schema, name } = this.resolve(given);
    let each = false;
    while (schema.type === "array" && schema.items) {
      ({ schema, name } = this.resolve(schema.items));
      each = true;
    }
    return schema.properties ? { inner: schema, name, each } : { inner: null, name, each };
  }

  members({ properties, required = [] }, above) {
    return el("dl", { class: "members" }, Object.entries(properties).map(([field, given]) => {
      const { schema } = this.resolve(given);
      const { inner, name, each } = this.inside(given);
      const values = this.values(given);
      return [
        el("dt", {}, el("code", { class: "field" }, field), " ", el("span", { class: "type" }, this.type(given)),
          required.includes(field) && el("span", { class: "required" }, "required"), bounds(schema), this.itemBounds(schema)),
        el("dd", {}, prose(schema.description), values && [this.ownWords(given), choices(values)],
          inner && !above.includes(name) && this.folded(inner, name, each, [...above, name])),
      ];
    }));
  }

  /** Made when it is first opened: some schemas are deep. */
  folded(inner, name, each, above) {
    const open = ({ target }) => {
      if (!target.open || target.childElementCount > 1) return;
      target.append(el("div", {}, this.ownWords({ $ref: `/${name}` })), this.members(inner, above));
    };
    const count = Object.keys(inner.properties).length;
    return el("details", { toggle: open }, el("summary", {}, each ? "each item: " : "", el("code", {}, name ?? "object"), `, ${count} fields`));
  }

  /** What a named schema says of itself, where the field that holds it says something else. */
  ownWords({ $ref, description }) {
    const own = $ref && this.named[$ref.split("/").at(-1)]?.description;
    return own && own !== description ? prose(own) : null;
  }

  values(given) {
    const { schema } = this.resolve(given);
    return schema.enum ?? (schema.items && this.resolve(schema.items).schema.enum);
  }

  /** A few words: `list of numbers`, `Transform`. */
  type(given, many = false) {
    const { schema, name } = this.resolve(given);
    if (schema.type === "array") return `list${many ? "s" : ""} of ${this.type(schema.items ?? {}, true)}`;
    if (name) return name;
    return [schema.type ?? "value"].flat().map((kind) => (many && kind !== "null" ? `${kind}s` : kind)).join(" or ");
  }

  itemBounds(schema) {
    let items = schema;
    while (items?.type === "array") items = this.resolve(items.items).schema;
    return items === schema ? null : bounds(items, "each ");
  }

  /** An example with its members in the order in which the schema names them. */
  ordered(value, given) {
    const { schema } = this.resolve(given);
    if (Array.isArray(value)) return value.map((item) => this.ordered(item, schema.items));
    if (value === null || typeof value !== "object" || !schema.properties) return value;
    const named = Object.keys(schema.properties).filter((name) => name in value);
    const names = [...named, ...Object.keys(value).filter((name) => !named.includes(name))];
    return Object.fromEntries(names.map((name) => [name, this.ordered(value[name], schema.properties[name])]));
  }
}

/** What a value must keep to, in a few words. */
export function bounds(schema, prefix = "") {
  const said = [];
  const shown = (value) => (Math.abs(value) >= 1e15 ? value.toExponential().replace("e+", "e") : number(value, 9));
  const span = (least, most, unit) => {
    if (least !== undefined && least === most) said.push(`${prefix}${shown(least)}${unit}`);
    else if (least !== undefined && most !== undefined) said.push(`${prefix}${shown(least)} … ${shown(most)}${unit}`);
    else if (least !== undefined) said.push(`${prefix}≥ ${shown(least)}${unit}`);
    else if (most !== undefined) said.push(`${prefix}≤ ${shown(most)}${unit}`);
  };
  span(schema.minimum, schema.maximum, "");
  span(schema.minLength, schema.maxLength, " characters");
  if (schema.type === "array") span(schema.minItems, schema.maxItems, " items");
  if (schema.multipleOf) said.push(`${prefix}a multiple of ${schema.multipleOf}`);
  if (schema.default !== undefined) said.push(`default ${JSON.stringify(schema.default)}`);
  const chips = said.map((text) => el("span", { class: "bound" }, text));
  if (schema.pattern && schema.type === "string") chips.push(el("code", { class: "bound" }, schema.pattern));
  return chips.map((chip) => [" ", chip]);
}

function choices(values) {
  return el("p", { class: "values" }, values.map((value) => el("code", { class: "value" }, JSON.stringify(value))));
}

/** The parameters of an operation. */
export function parameters(list, schemas) {
  return el("dl", { class: "members" }, list.map((parameter) => {
    const { schema } = schemas.resolve(parameter.schema);
    const values = schemas.values(parameter.schema);
    return [
      el("dt", {}, el("code", { class: "field" }, parameter.name), " ",
        el("span", { class: "type" }, `${parameter.in}, ${schemas.type(parameter.schema)}`),
        parameter.required && el("span", { class: "required" }, "required"), bounds(schema)),
      el("dd", {}, el("p", {}, inline(parameter.description)), values && choices(values)),
    ];
  }));
}
