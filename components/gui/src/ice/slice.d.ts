// Ice's runtime and the classes of our Slice files, made by slice_plugin.ts. Untyped: only src/ice sees them, and src/ice/convert.ts
// turns what comes from them into the typed values of src/shared/state.ts.
declare module "virtual:slice" {
  // eslint-disable-next-line @typescript-eslint/no-explicit-any
  export const IceRuntime: any;
  export const Glacier2Module: any;
  export const avmModule: any;
  export const jderobotModule: any;
}
