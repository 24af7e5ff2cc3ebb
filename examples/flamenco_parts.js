// A job type of Flamenco 3 that renders a picture in parts and merges them: a template that has not been run. It belongs in
// the folder `scripts` beside the manager. Scene and folder are on a file system that all workers have.
const JOB_TYPE = {
    label: "Pertev in parts",
    settings: [
        { key: "scene", type: "string", required: true, subtype: "file_path" },
        { key: "folder", type: "string", required: true, subtype: "dir_path" },
        { key: "parts", type: "int32", default: 16 },
        { key: "spp", type: "int32", default: 1024 },
    ],
};

function compileJob(job) {
    const { scene, folder, parts, spp } = job.settings;
    const files = [];
    const merge = author.Task("merge", "misc");
    for (let i = 1; i <= parts; i++) {
        files.push(`${folder}/part.${i}.pvf`);
        const task = author.Task(`part ${i}`, "misc");
        task.addCommand(author.Command("exec", {
            exe: "pertev",
            args: ["render", scene, "-o", files[i - 1], "--part", `${i}/${parts}`, "--spp", `${spp}`,
                   "--checkpoint", `${folder}/checkpoint.${i}.pvf`],
        }));
        merge.addDependency(task);
        job.addTask(task);
    }
    merge.addCommand(author.Command("exec", { exe: "pertev", args: ["merge", ...files, "-o", `${folder}/picture.exr`] }));
    job.addTask(merge);
}
