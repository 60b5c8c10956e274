"""Trains agents for the environments of anergy.gym with PPO of stable-baselines3, and compares them with the rules.

python examples/learning/train.py [--steps N] [NAME ...]      needs pip install anergy[rl] stable-baselines3
"""

import argparse

import anergy.gym
import gymnasium
from stable_baselines3 import PPO
from stable_baselines3.common.env_util import make_vec_env

EPISODES = 20
"""Episodes of each score; their seeds occur in no training."""
FIRST_SEED = 10_000

parser = argparse.ArgumentParser()
parser.add_argument("names", nargs="*", default=["Pumps", "House", "District"])
parser.add_argument("--steps", type=int, default=200_000)
parser.add_argument("--seed", type=int, default=1)
arguments = parser.parse_args()

print("| environment | random | rule | agent | steps of training |\n|---|---|---|---|---|")
for name in arguments.names:
    env = gymnasium.make(f"anergy/{name}-v0").unwrapped
    training = make_vec_env(type(env), n_envs=8, seed=arguments.seed)
    agent = PPO(
        "MlpPolicy",
        training,
        n_steps=256,
        batch_size=256,
        learning_rate=1e-3,
        gamma=0.98,
        ent_coef=0.0,
        use_sde=True,
        policy_kwargs={"log_std_init": -2.0, "net_arch": [64, 64]},
        seed=arguments.seed,
        device="cpu",
    )
    agent.learn(arguments.steps)

    def act(observation, agent=agent):
        return agent.predict(observation, deterministic=True)[0]

    scores = [anergy.gym.score(env, policy, EPISODES, FIRST_SEED) for policy in (None, env.baseline(), act)]
    told = " | ".join(f"{score.mean():.1f} ± {score.std():.1f}" for score in scores)
    print(f"| {name} | {told} | {arguments.steps} |", flush=True)
