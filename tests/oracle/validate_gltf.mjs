// node validate_gltf.mjs PACKAGE_DIR FILE...
//
// Holds each glTF against the specification by Khronos' validator, the npm package `gltf-validator`
// installed in PACKAGE_DIR. Prints errors and warnings; ends 1 if there are any.
import { existsSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";

const [packageDir, ...files] = process.argv.slice(2);
if (!existsSync(join(packageDir, "node_modules", "gltf-validator"))) {
    console.log("gltf-validator is not installed: nothing was validated");
    process.exit(77);
}
const { validateBytes } = createRequire(join(resolve(packageDir), "package.json"))("gltf-validator");

let failed = false;
for (const file of files) {
    const { issues } = await validateBytes(new Uint8Array(readFileSync(file)), { maxIssues: 0 });
    console.log(`${file}: ${issues.numErrors} errors, ${issues.numWarnings} warnings`);
    for (const issue of issues.messages) {
        if (issue.severity > 1) continue;
        console.log(`  ${issue.pointer}: ${issue.code}: ${issue.message}`);
        failed = true;
    }
}
process.exit(failed ? 1 : 0);
