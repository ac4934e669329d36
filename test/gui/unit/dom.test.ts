// Words and numbers that all panes share.
import assert from "node:assert/strict";
import {test} from "node:test";
import {clockText, fixed} from "@gui/panes/dom";

test("a stamp is shown with hours, minutes, seconds and milliseconds", () => {
  const local = new Date(2026, 0, 2, 3, 4, 5, 6);
  assert.equal(clockText(1000 * local.getTime()), "03:04:05.006");
});

test("a number that is rounded to zero has no sign", () => {
  assert.deepEqual([fixed(-0.001, 2), fixed(-0.2, 0), fixed(-0.006, 2), fixed(undefined, 2)], ["0.00", "0", "-0.01", "-"]);
});
